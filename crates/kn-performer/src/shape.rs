//! The solids of the figure as signed distances (negative inside), each in the frame of its bone.
//! Distances are exact or, for lofts, of first order: their gradient stays below [`LIPSCHITZ`],
//! which is what the sparse sampling relies on.

use super::random::Random;
use glam::DVec3;

/// Bound on the gradient of every shape, wrinkles included.
pub(super) const LIPSCHITZ: f64 = 1.3;

#[derive(Clone, Debug)]
pub(super) enum Shape {
    /// The hull of two balls.
    Cone {
        a: DVec3,
        b: DVec3,
        ra: f64,
        rb: f64,
    },
    Ellipsoid {
        centre: DVec3,
        radii: DVec3,
    },
    Loft(Loft),
}

impl Shape {
    pub(super) fn ball(centre: DVec3, radius: f64) -> Self {
        Self::Ellipsoid { centre, radii: DVec3::splat(radius) }
    }

    pub(super) fn distance(&self, at: DVec3) -> f64 {
        match self {
            Self::Cone { a, b, ra, rb } => cone(at, *a, *b, *ra, *rb),
            Self::Ellipsoid { centre, radii } => ellipsoid(at - *centre, *radii),
            Self::Loft(loft) => loft.distance(at),
        }
    }
}

/// Exact: the problem is plane in (height along the axis, distance from it), where the side is a
/// straight line tangent to both circles.
fn cone(at: DVec3, a: DVec3, b: DVec3, ra: f64, rb: f64) -> f64 {
    let axis = b - a;
    let length = axis.length();
    let height = (at - a).dot(axis) / length;
    let away = ((at - a).length_squared() - height * height).max(0.0).sqrt();
    let sine = (ra - rb) / length;
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let foot = height * cosine - away * sine;
    if foot < 0.0 {
        (at - a).length() - ra
    } else if foot > length * cosine {
        (at - b).length() - rb
    } else {
        away * cosine + height * sine - ra
    }
}

/// First order at the surface: (k₀ − 1) scaled by the length of its gradient.
fn ellipsoid(at: DVec3, radii: DVec3) -> f64 {
    let k0 = (at / radii).length();
    let k1 = (at / (radii * radii)).length();
    if k1 < 1e-9 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// One height of a loft.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    pub(super) y: f64,
    /// Half axes along x and z, and the centre's z.
    pub(super) rx: f64,
    pub(super) rz: f64,
    pub(super) z: f64,
}

pub(super) const fn station(y: f64, rx: f64, rz: f64, z: f64) -> Station {
    Station { y, rx, rz, z }
}

/// A solid of rounded-box cross sections along y, with pleats and an open hem where it hangs.
#[derive(Clone, Debug)]
pub(super) struct Loft {
    /// By falling y.
    pub(super) stations: Vec<Station>,
    /// Radius of the rounding at both ends, metres.
    pub(super) rounding: f64,
    /// 0: elliptic sections; 1: superellipses of the fourth order.
    pub(super) boxy: f64,
    /// Depth of the hollow above the lower end and the thickness of its wall; 0 for none.
    pub(super) hollow: f64,
    pub(super) wall: f64,
    pub(super) pleats: Option<Pleats>,
}

/// Folds that run down hanging cloth: waves around the axis that grow towards the hem.
#[derive(Clone, Debug)]
pub(super) struct Pleats {
    /// Metres at the hem.
    pub(super) depth: f64,
    /// Waves around the circumference, share of the depth and phase.
    pub(super) waves: [(f64, f64, f64); 4],
    pub(super) top: f64,
    pub(super) hem: f64,
}

impl Loft {
    fn distance(&self, at: DVec3) -> f64 {
        let (top, low) = (self.stations[0].y, self.stations[self.stations.len() - 1].y);
        let inside_y = at.y.clamp(low, top);
        let (section, slope) = self.section(inside_y);
        let plain = self.side(at, &section) / (1.0 + slope * slope).sqrt();
        let mut side = plain;
        if let Some(pleats) = &self.pleats {
            let share = 1.0 - (side / 0.06) * (side / 0.06);
            if share > 0.0 {
                side -= pleats.height(at, &section) * share;
            }
        }
        let ends = (at.y - top).max(low - at.y);
        let solid = rounded_corner(side, ends, self.rounding);
        if self.hollow <= 0.0 {
            return solid;
        }
        // The wall keeps its thickness in front of the pleats and behind them.
        let cavity = rounded_corner(side.max(plain) + self.wall, at.y - low - self.hollow, 0.015);
        super::field::smooth_max(solid, -cavity, 0.012)
    }

    /// Signed distance in the plane of a section, first order.
    fn side(&self, at: DVec3, section: &Station) -> f64 {
        let (x, z) = (at.x / section.rx, (at.z - section.z) / section.rz);
        let k2 = (x * x + z * z).sqrt();
        let k4 = (x * x * x * x + z * z * z * z).sqrt().sqrt();
        let k0 = k2 + self.boxy * (k4 - k2);
        let (gx, gz) = (x / section.rx, z / section.rz);
        let k1 = (gx * gx + gz * gz).sqrt();
        if k1 < 1e-9 { -section.rx.min(section.rz) } else { (k0 - 1.0) * k2 / k1 }
    }

    /// The section at a height between the ends, and the steepest slope of its outline there.
    fn section(&self, y: f64) -> (Station, f64) {
        let stations = &self.stations;
        let last = stations.len() - 2;
        let i = stations[1..].iter().position(|s| y >= s.y).unwrap_or(last).min(last);
        let before = &stations[i.saturating_sub(1)];
        let (a, b) = (&stations[i], &stations[i + 1]);
        let after = &stations[(i + 2).min(stations.len() - 1)];
        let span = a.y - b.y;
        let t = (a.y - y) / span;
        let spline = |of: fn(&Station) -> f64| {
            // Hermite with central differences: smooth where stations are spaced unevenly.
            let slope_a = (of(b) - of(before)) / (before.y - b.y).max(span);
            let slope_b = (of(after) - of(a)) / (a.y - after.y).max(span);
            hermite(of(a), slope_a * span, of(b), slope_b * span, t)
        };
        let (rx, dx) = spline(|s| s.rx);
        let (rz, dz) = spline(|s| s.rz);
        let (z, shift) = spline(|s| s.z);
        let slope = (dx.abs().max(dz.abs()) + shift.abs()) / span;
        (Station { y, rx, rz, z }, slope)
    }
}

/// Value and derivative at t of the cubic from `a` to `b` with end slopes `da` and `db`.
fn hermite(a: f64, da: f64, b: f64, db: f64, t: f64) -> (f64, f64) {
    let c = 3.0 * (b - a) - 2.0 * da - db;
    let d = 2.0 * (a - b) + da + db;
    (a + t * (da + t * (c + t * d)), da + t * (2.0 * c + 3.0 * t * d))
}

/// The meet of two half-spaces given by their distances, its edge rounded.
fn rounded_corner(a: f64, b: f64, rounding: f64) -> f64 {
    let (u, v) = (a + rounding, b + rounding);
    let outside = (u.max(0.0) * u.max(0.0) + v.max(0.0) * v.max(0.0)).sqrt();
    u.max(v).min(0.0) + outside - rounding
}

impl Pleats {
    fn height(&self, at: DVec3, section: &Station) -> f64 {
        let down = ((self.top - at.y) / (self.top - self.hem)).clamp(0.0, 1.0);
        let angle = libm::atan2(at.x / section.rx, (at.z - section.z) / section.rz);
        let mut sum = 0.0;
        for &(waves, share, phase) in &self.waves {
            // Pleats lean with height, or they would look turned on a lathe.
            sum += share * libm::cos(waves * angle + phase + 2.2 * down * (share - 0.5));
        }
        // Rounded outwards, narrow inwards.
        self.depth * down * down.sqrt() * (sum - 0.25 * sum * sum)
    }
}

/// Small folds of worn cloth, hair and the like: noise in the bone's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrinkles {
    /// Metres.
    pub(super) depth: f64,
    /// Periods per metre along the bone's axes.
    pub(super) frequency: DVec3,
    pub(super) random: Random,
}

impl Wrinkles {
    /// Height of the wrinkle at `at`, a point at `distance` from the surface; it fades with
    /// distance so that the field stays continuous where wrinkles no longer matter.
    pub(super) fn height(&self, at: DVec3, distance: f64, drift: DVec3, strength: f64) -> f64 {
        const REACH: f64 = 0.04;
        let share = 1.0 - (distance / REACH) * (distance / REACH);
        if share <= 0.0 || self.depth == 0.0 {
            return 0.0;
        }
        let place = at * self.frequency + drift;
        let coarse = self.random.noise(place);
        let fine = self.random.noise(place * 2.17 + DVec3::splat(31.7));
        // Ridges: cloth folds are sharper than the dips between them.
        let fold = 0.7 - 2.0 * coarse.abs() + 0.5 * fine;
        self.depth * strength * share * share * fold
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> Vec<Shape> {
        let stations = vec![
            station(0.3, 0.05, 0.05, 0.0),
            station(0.2, 0.17, 0.11, 0.01),
            station(-0.3, 0.2, 0.17, 0.0),
        ];
        let waves = [(7.0, 0.5, 0.3), (9.0, 0.3, 1.0), (12.0, 0.2, 2.0), (5.0, 0.3, 0.1)];
        let pleats = Some(Pleats { depth: 0.012, waves, top: 0.0, hem: -0.3 });
        vec![
            Shape::Cone { a: DVec3::ZERO, b: DVec3::NEG_Y * 0.3, ra: 0.08, rb: 0.05 },
            Shape::Ellipsoid { centre: DVec3::ZERO, radii: DVec3::new(0.08, 0.11, 0.1) },
            Shape::Loft(Loft {
                stations,
                rounding: 0.02,
                boxy: 0.4,
                hollow: 0.1,
                wall: 0.03,
                pleats,
            }),
        ]
    }

    /// A surface point on the way between an inner and an outer one.
    fn crossing(shape: &Shape, mut inner: DVec3, mut outer: DVec3) -> DVec3 {
        for _ in 0..50 {
            let middle = (inner + outer) / 2.0;
            if shape.distance(middle) < 0.0 { inner = middle } else { outer = middle }
        }
        inner
    }

    #[test]
    fn no_distance_is_overstated_by_more_than_the_bound() {
        let random = Random::new(3, 9);
        for shape in shapes() {
            let surface: Vec<DVec3> = (0..300)
                .map(|i| crossing(&shape, DVec3::Y * -0.1, 2.0 * random.vector(i)))
                .filter(|at| shape.distance(*at).abs() < 1e-9)
                .collect();
            for i in 0..2000 {
                let at = 0.5 * random.vector(i + 10_000);
                let stated = shape.distance(at).abs();
                let nearest = surface.iter().map(|s| (*s - at).length()).fold(9.0, f64::min);
                assert!(stated <= LIPSCHITZ * nearest, "{} at {at}, {shape:?}", stated / nearest);
            }
        }
    }
}
