//! A z-buffer with smooth shading: meshes to pixels without a GPU.

use super::canvas::{Canvas, Colour};
use super::view::View;
use kn_mesh::Mesh;
use kn_mesh::vec3::sub;

/// The paint of a surface.
#[derive(Clone, Copy)]
pub(crate) enum Paint<'a> {
    /// One colour.
    Plain(Colour),
    /// `#V` colours, interpolated.
    PerVertex(&'a [Colour]),
}

/// Samples per pixel along each axis.
const SUPERSAMPLING: usize = 3;

/// Linear light, 0 to 1.
type Light = [f32; 3];

/// One picture of a mesh. The inside of an open surface is drawn darker.
pub(crate) fn render(mesh: &Mesh, paint: Paint<'_>, view: &View, size: [usize; 2]) -> Canvas {
    let [width, height] = size.map(|side| side * SUPERSAMPLING);
    let normals = vertex_normals(mesh);
    let corner = |vertex: u32| {
        let at = vertex as usize;
        let colour = match paint {
            Paint::Plain(colour) => colour,
            Paint::PerVertex(colours) => colours[at],
        };
        Corner {
            screen: view.project(mesh.positions[at], width, height),
            normal: view.turn(normals[at]),
            colour: colour.map(linear_of),
        }
    };
    let mut samples = Samples::new(width, height);
    for face in &mesh.faces {
        samples.triangle(face.map(corner));
    }
    samples.average(size)
}

/// A corner of a triangle in the camera's axes.
#[derive(Clone, Copy)]
struct Corner {
    /// Right, down, towards the viewer.
    screen: [f32; 3],
    normal: [f32; 3],
    colour: Light,
}

/// The supersampled picture.
struct Samples {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    light: Vec<Light>,
}

impl Samples {
    fn new(width: usize, height: usize) -> Self {
        let light = vec![super::PAPER.map(linear_of); width * height];
        Self { width, height, depth: vec![f32::NEG_INFINITY; width * height], light }
    }

    /// Draws one triangle: barycentric coordinates from edge functions at every sample's centre.
    fn triangle(&mut self, corners: [Corner; 3]) {
        let [a, b, c] = corners.map(|corner| corner.screen);
        let area = edge(a, b, c[0], c[1]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let xs = span([a[0], b[0], c[0]], self.width);
        for y in span([a[1], b[1], c[1]], self.height) {
            for x in xs.clone() {
                let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                let weights =
                    [edge(b, c, px, py), edge(c, a, px, py), edge(a, b, px, py)].map(|e| e / area);
                if weights.iter().all(|&weight| weight >= 0.0) {
                    self.sample(y * self.width + x, &corners, weights);
                }
            }
        }
    }

    fn sample(&mut self, at: usize, corners: &[Corner; 3], weights: [f32; 3]) {
        let mix = |pick: fn(&Corner) -> [f32; 3]| -> [f32; 3] {
            let values = corners.each_ref().map(pick);
            std::array::from_fn(|i| (0..3).map(|k| values[k][i] * weights[k]).sum())
        };
        let depth = mix(|corner| corner.screen)[2];
        if depth > self.depth[at] {
            self.depth[at] = depth;
            self.light[at] = shade(mix(|corner| corner.normal), mix(|corner| corner.colour));
        }
    }

    /// The picture: the mean of each pixel's samples, in linear light.
    fn average(&self, [width, height]: [usize; 2]) -> Canvas {
        let mut canvas = Canvas::new(width, height, super::PAPER);
        for y in 0..height {
            for x in 0..width {
                let mut sum = [0.0; 3];
                for sample in 0..SUPERSAMPLING * SUPERSAMPLING {
                    let row = y * SUPERSAMPLING + sample / SUPERSAMPLING;
                    let column = x * SUPERSAMPLING + sample % SUPERSAMPLING;
                    let light = self.light[row * self.width + column];
                    sum = std::array::from_fn(|i| sum[i] + light[i]);
                }
                let mean = sum.map(|s| s / (SUPERSAMPLING * SUPERSAMPLING) as f32);
                canvas.set(x, y, mean.map(srgb_of));
            }
        }
        canvas
    }
}

/// Twice the signed area of the triangle p, q, (x, y).
fn edge(p: [f32; 3], q: [f32; 3], x: f32, y: f32) -> f32 {
    (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
}

/// The samples that the coordinates of a triangle can touch.
fn span(values: [f32; 3], limit: usize) -> std::ops::Range<usize> {
    let low = values[0].min(values[1]).min(values[2]).floor().max(0.0);
    let high = values[0].max(values[1]).max(values[2]).ceil().max(0.0);
    low as usize..(high as usize).min(limit)
}

/// Light on a surface with this normal (camera's axes, any length): sky, key light, fill light.
fn shade(normal: [f32; 3], colour: Light) -> Light {
    const KEY: [f32; 3] = [-0.48, 0.56, 0.68];
    const FILL: [f32; 3] = [0.80, 0.10, 0.59];
    const INSIDE: f32 = 0.45;
    let length = normal.map(|x| x * x).iter().sum::<f32>().sqrt().max(1e-20);
    let (facing, outside) = if normal[2] < 0.0 { (-1.0, INSIDE) } else { (1.0, 1.0) };
    let n = normal.map(|x| facing * x / length);
    let toward = |light: [f32; 3]| (0..3).map(|i| n[i] * light[i]).sum::<f32>().max(0.0);
    let sky = 0.5 + 0.5 * n[1];
    let brightness = outside * (0.16 + 0.16 * sky + 0.62 * toward(KEY) + 0.20 * toward(FILL));
    colour.map(|c| c * brightness)
}

/// `#V × 3` normals, the sum of the faces' area vectors; not unit length.
fn vertex_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; mesh.positions.len()];
    for face in &mesh.faces {
        let [a, b, c] = face.map(|vertex| mesh.positions[vertex as usize]);
        let (u, v): ([f32; 3], [f32; 3]) =
            (sub(b, a).map(|x| x as f32), sub(c, a).map(|x| x as f32));
        let cross: [f32; 3] = std::array::from_fn(|i| {
            u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]
        });
        for &vertex in face {
            let normal = &mut normals[vertex as usize];
            *normal = std::array::from_fn(|i| normal[i] + cross[i]);
        }
    }
    normals
}

/// IEC 61966-2-1.
fn linear_of(channel: u8) -> f32 {
    let value = f32::from(channel) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// IEC 61966-2-1.
fn srgb_of(light: f32) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let value =
        if light <= 0.0031308 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_bitstream::params::UpAxis;
    use kn_mesh::BoundingBox;

    fn square_at(z: f64) -> Mesh {
        let positions = vec![[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]];
        Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])
    }

    fn view() -> View {
        View::new(&BoundingBox { min: [-1.0; 3], max: [1.0; 3] }, UpAxis::Y, 0.0)
    }

    #[test]
    fn a_square_fills_the_middle_and_leaves_the_corner() {
        let picture = render(&square_at(0.0), Paint::Plain([200, 0, 0]), &view(), [40, 40]);
        let middle = picture.pixel(20, 20);
        assert!(middle[0] > 120 && middle[1] == 0, "{middle:?}");
        assert_eq!(picture.pixel(0, 0), super::super::PAPER);
    }

    #[test]
    fn what_is_nearer_hides_what_is_behind_in_either_order() {
        let (mut near_first, far) = (square_at(0.5), square_at(-0.5));
        near_first.positions.extend(&far.positions);
        near_first.faces.extend([[4, 5, 6], [4, 6, 7]]);
        let mut far_first = near_first.clone();
        far_first.faces.rotate_left(2);
        let colours = [[[0, 200, 0]; 4], [[200, 0, 0]; 4]].concat();
        for mesh in [near_first, far_first] {
            let picture = render(&mesh, Paint::PerVertex(&colours), &view(), [40, 40]);
            let middle = picture.pixel(20, 20);
            assert!(middle[1] > 100 && middle[0] == 0, "{middle:?}");
        }
    }

    #[test]
    fn the_inside_is_darker_and_bad_triangles_are_skipped() {
        let mut mesh = square_at(0.0);
        let front = render(&mesh, Paint::Plain([200; 3]), &view(), [20, 20]).pixel(10, 10);
        for face in &mut mesh.faces {
            face.swap(0, 1);
        }
        mesh.positions.push([f64::NAN; 3]);
        mesh.faces.extend([[0, 0, 1], [0, 1, 4]]);
        let back = render(&mesh, Paint::Plain([200; 3]), &view(), [20, 20]).pixel(10, 10);
        assert!(back[0] < front[0]);
    }

    #[test]
    fn srgb_comes_back() {
        for channel in 0..=255 {
            assert_eq!(srgb_of(linear_of(channel)), channel);
        }
    }
}
