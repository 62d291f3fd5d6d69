//! The meshes that are written, and what spoils them in any format.

use super::random::Random;
use std::f64::consts::TAU;

/// A mesh of polygons.
pub(super) struct Shape {
    pub(super) positions: Vec<[f64; 3]>,
    /// Indices into `positions`; a spoilt shape has others too.
    pub(super) faces: Vec<Vec<i64>>,
}

impl Shape {
    pub(super) fn any(random: &mut Random) -> Self {
        let mut shape = match random.below(4) {
            0 => Self::prism(&[[0.0, 0.0], [1.0, 0.3], [2.0, 0.0], [1.0, 2.0]]),
            1 => Self::prism(&star(3 + random.below(9), random)),
            2 => Self {
                positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
                faces: vec![vec![0, 1, 2]],
            },
            _ => Self::tube(3 + random.below(8), 2 + random.below(6)),
        };
        if random.chance(2) {
            shape.cut();
        }
        let far = random.pick(&[0.0, 0.0, 100.0, 691_234.567, -1e7]);
        let scale = random.pick(&[1.0, 1.0, 1e-3, 1e3]);
        for coordinate in shape.positions.as_flattened_mut() {
            *coordinate = *coordinate * scale + far;
        }
        shape
    }

    /// A closed tube of quads with polygons at its ends.
    fn tube(around: usize, rings: usize) -> Self {
        let place = |at: usize| {
            let (ring, corner) = (at / around, at % around);
            let angle = corner as f64 / around as f64 * TAU;
            let radius = 0.2 + 0.05 * (ring as f64).sin();
            [radius * angle.cos(), 0.3 * ring as f64, radius * angle.sin()]
        };
        let index = |ring: usize, corner: usize| (ring * around + corner % around) as i64;
        let mut faces = Vec::new();
        for ring in 1..rings {
            for corner in 0..around {
                let (low, high) = (ring - 1, ring);
                let quad = [(low, corner), (high, corner), (high, corner + 1), (low, corner + 1)];
                faces.push(quad.map(|(ring, corner)| index(ring, corner)).to_vec());
            }
        }
        faces.push((0..around as i64).collect());
        faces.push((0..around).rev().map(|corner| index(rings - 1, corner)).collect());
        Self { positions: (0..around * rings).map(place).collect(), faces }
    }

    /// A prism over a polygon.
    fn prism(base: &[[f64; 2]]) -> Self {
        let count = base.len() as i64;
        let level = |height: f64| base.iter().map(move |[x, y]| [*x, *y, height]);
        let mut faces: Vec<Vec<i64>> = (0..count)
            .map(|at| (at, (at + 1) % count))
            .map(|(a, b)| vec![a, b, b + count, a + count])
            .collect();
        faces.push((0..count).rev().collect());
        faces.push((count..2 * count).collect());
        Self { positions: level(0.0).chain(level(0.5)).collect(), faces }
    }

    /// Cuts all polygons into fans.
    fn cut(&mut self) {
        let fan = |face: &Vec<i64>| {
            let corners = face.clone();
            (2..face.len()).map(move |at| vec![corners[0], corners[at - 1], corners[at]])
        };
        self.faces = self.faces.iter().flat_map(fan).collect();
    }

    /// One to four of the faults that files of every format have.
    pub(super) fn spoil(&mut self, random: &mut Random) {
        for _ in 0..1 + random.below(4) {
            match random.below(14) {
                0 => self.positions.push([f64::NAN, 0.0, 0.0]),
                1 => *self.vertex(random) = random.pick(&[f64::NAN, f64::INFINITY, -f64::INFINITY]),
                2 => *self.vertex(random) = random.pick(&[1e39, -1e300, 1e-310, 4e18, 1.7e308]),
                3 => self.faces.push(vec![0; random.below(6)]),
                4 => self.faces.push((0..random.below(3) as i64).collect()),
                5 => self.face(random).reverse(),
                6 => {
                    let corner = random.pick(&[-1, 1 << 20, 1 << 31, 1 << 33, i64::MIN, 9]);
                    self.face(random).push(corner);
                }
                7 => {
                    let again = self.face(random).clone();
                    self.faces.push(again);
                }
                8 => {
                    let corner = self.face(random).first().copied().unwrap_or(0);
                    self.face(random).insert(0, corner);
                }
                9 => self.positions.iter_mut().for_each(|position| *position = [1.0; 3]),
                10 => self.positions.iter_mut().for_each(|position| position[1] = position[0]),
                11 => self.faces.clear(),
                12 => self.positions.truncate(random.below(3)),
                _ => self.shuffle(random),
            }
        }
    }

    /// Any coordinate.
    fn vertex(&mut self, random: &mut Random) -> &mut f64 {
        if self.positions.is_empty() {
            self.positions.push([0.0; 3]);
        }
        let at = random.below(self.positions.len());
        &mut self.positions[at][random.below(3)]
    }

    fn face(&mut self, random: &mut Random) -> &mut Vec<i64> {
        if self.faces.is_empty() {
            self.faces.push(vec![0, 1, 2]);
        }
        let at = random.below(self.faces.len());
        &mut self.faces[at]
    }

    /// Faces of random vertices.
    fn shuffle(&mut self, random: &mut Random) {
        let count = self.positions.len();
        for corner in self.faces.iter_mut().flatten() {
            *corner = random.below(count) as i64;
        }
    }
}

/// A polygon whose corners lie near the centre and far from it.
fn star(corners: usize, random: &mut Random) -> Vec<[f64; 2]> {
    let mut corner = |at: usize| {
        let angle = at as f64 / corners as f64 * TAU;
        let radius = 0.2 + random.unit();
        [radius * angle.cos(), radius * angle.sin()]
    };
    (0..corners).map(&mut corner).collect()
}
