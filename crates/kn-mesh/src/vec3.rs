//! Vectors of three binary64 numbers as plain arrays. Each function is one expression in the order
//! that it shows, without fused multiply-add, so that normative code can use it where the
//! specification writes the same order.

/// x, y, z.
pub type Vec3 = [f64; 3];

/// `a + b`.
#[inline]
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a − b`.
#[inline]
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `s · a`.
#[inline]
pub fn scale(a: Vec3, s: f64) -> Vec3 {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// `a + t · b`, rounded twice per coordinate.
#[inline]
pub fn mul_add(a: Vec3, t: f64, b: Vec3) -> Vec3 {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

/// The scalar product, summed from x to z.
#[inline]
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product `a × b`.
#[inline]
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a · a`.
#[inline]
pub fn norm_squared(a: Vec3) -> f64 {
    dot(a, a)
}

/// The length of `a`.
#[inline]
pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The squared distance of two points.
#[inline]
pub fn distance_squared(a: Vec3, b: Vec3) -> f64 {
    norm_squared(sub(a, b))
}

/// The distance of two points.
#[inline]
pub fn distance(a: Vec3, b: Vec3) -> f64 {
    norm(sub(a, b))
}

/// `a` at length 1; zero where it has no direction.
#[inline]
pub fn unit(a: Vec3) -> Vec3 {
    let length = norm(a);
    if length > 0.0 { scale(a, 1.0 / length) } else { [0.0; 3] }
}
