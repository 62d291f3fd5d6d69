//! The exact closest point on one triangle, in binary64.

use kn_mesh::vec3::{Vec3, cross, distance_squared, dot, mul_add, norm_squared, scale, sub};

/// Squared ratio of the height to the longest side, below which barycentric coordinates have too
/// few digits to say alone which sides a point can see.
const THIN: f64 = 1e-8;

/// A triangle prepared for queries.
///
/// The corners are sorted by position. A shared edge thus enters the same arithmetic from each of
/// its faces, whatever their orientation, and gives equal bits: a tie is seen as a tie.
#[derive(Clone, Debug)]
pub(super) struct Triangle {
    corners: [Vec3; 3],
    /// Gradients of the barycentric coordinates of the second and third corner; zero where the
    /// triangle is a segment or a point.
    gradients: [Vec3; 2],
    /// The corner of the face that each sorted corner is.
    order: [u8; 3],
    thin: bool,
}

/// A point of a triangle: where it is and how far from the query.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) point: Vec3,
    /// In the order of the face's corners once [`Triangle::in_face_order`] was applied.
    pub(super) weights: Vec3,
    pub(super) distance_squared: f64,
}

impl Triangle {
    pub(super) fn new(face: [Vec3; 3]) -> Self {
        let mut order = [0u8, 1, 2];
        order.sort_by(|&i, &j| {
            let (a, b) = (face[usize::from(i)], face[usize::from(j)]);
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
        });
        let corners = order.map(|corner| face[usize::from(corner)]);
        let (ab, ac) = (sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let normal = cross(ab, ac);
        let area = norm_squared(normal);
        let longest = [ab, ac, sub(corners[2], corners[1])].map(norm_squared);
        let longest = longest.into_iter().fold(0.0, f64::max);
        let thin = area <= THIN * longest * longest;
        let gradients = if area > 0.0 && area.recip().is_finite() {
            [scale(cross(ac, normal), 1.0 / area), scale(cross(normal, ab), 1.0 / area)]
        } else {
            [[0.0; 3]; 2]
        };
        Self { corners, gradients, order, thin }
    }

    /// The closest point; its weights are those of the sorted corners.
    #[inline]
    pub(super) fn closest(&self, point: Vec3) -> Foot {
        if self.thin {
            return self.closest_if_thin(point);
        }
        let ap = sub(point, self.corners[0]);
        let (v, w) = (dot(ap, self.gradients[0]), dot(ap, self.gradients[1]));
        let u = 1.0 - v - w;
        if u >= 0.0 && v >= 0.0 && w >= 0.0 {
            return self.foot(point, [u, v, w]);
        }
        // The closest point of a convex set lies on a side that the query can see.
        self.closest_of_sides(point, [w < 0.0, v < 0.0, u < 0.0])
    }

    /// All sides, and the inside after one step of iterative refinement: the better is right to
    /// about 1e-12 of the longest side, however thin the triangle is.
    #[cold]
    fn closest_if_thin(&self, point: Vec3) -> Foot {
        let [a, b, c] = self.corners;
        let (mut v, mut w) = (0.0, 0.0);
        for _ in 0..2 {
            let rest = sub(point, mul_add(mul_add(a, v, sub(b, a)), w, sub(c, a)));
            v += dot(rest, self.gradients[0]);
            w += dot(rest, self.gradients[1]);
        }
        let side = self.closest_of_sides(point, [true; 3]);
        if !(v > 0.0 && w > 0.0 && v + w < 1.0) {
            return side;
        }
        let inside = self.foot(point, [1.0 - v - w, v, w]);
        if inside.distance_squared < side.distance_squared { inside } else { side }
    }

    fn foot(&self, query: Vec3, weights: Vec3) -> Foot {
        let [a, b, c] = self.corners;
        let point = mul_add(mul_add(a, weights[1], sub(b, a)), weights[2], sub(c, a));
        Foot { point, weights, distance_squared: distance_squared(query, point) }
    }

    /// The closest point on the wanted ones of the sides ab, ac, bc.
    #[inline]
    fn closest_of_sides(&self, point: Vec3, wanted: [bool; 3]) -> Foot {
        let mut best = Foot { point, weights: [0.0; 3], distance_squared: f64::INFINITY };
        for (side, [i, j]) in [[0, 1], [0, 2], [1, 2]].into_iter().enumerate() {
            if !wanted[side] {
                continue;
            }
            let (t, foot) = closest_on_segment(point, self.corners[i], self.corners[j]);
            let distance_squared = distance_squared(point, foot);
            if distance_squared < best.distance_squared {
                let mut weights = [0.0; 3];
                weights[i] = 1.0 - t;
                weights[j] = t;
                best = Foot { point: foot, weights, distance_squared };
            }
        }
        best
    }

    /// Brings the weights from the sorted corners back to the corners of the face.
    pub(super) fn in_face_order(&self, foot: Foot) -> Foot {
        let mut weights = [0.0; 3];
        for (sorted, &corner) in self.order.iter().enumerate() {
            weights[usize::from(corner)] = foot.weights[sorted];
        }
        Foot { weights, ..foot }
    }
}

/// The closest point of the segment from `a` to `b`, and its parameter in 0..=1.
#[inline]
fn closest_on_segment(point: Vec3, a: Vec3, b: Vec3) -> (f64, Vec3) {
    let ab = sub(b, a);
    let along = dot(sub(point, a), ab);
    let whole = norm_squared(ab);
    if along >= whole && whole > 0.0 {
        (1.0, b)
    } else if along > 0.0 {
        let t = along / whole;
        (t, mul_add(a, t, ab))
    } else {
        (0.0, a)
    }
}
