//! A plane about a point of the earth.
//!
//! x = R_N cos φ₀ (λ − λ₀),  y = R_M (φ − φ₀)        R_N, R_M radii of curvature of the ellipsoid at φ₀
//!
//! Source: Snyder, *Map Projections: A Working Manual*, USGS Professional Paper 1395 (1987), page 24, for the radii; the
//! ellipsoid is that of WGS 84. Good to some parts in a thousand within 10 km.

/// Half of the great axis of the ellipsoid [m], WGS 84.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// Its flattening, WGS 84.
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// East and north of a place from an origin [m], both as latitude and longitude [°].
pub fn plane(origin: (f64, f64), place: (f64, f64)) -> [f64; 2] {
    let (sin, cos) = origin.0.to_radians().sin_cos();
    let e2 = FLATTENING * (2.0 - FLATTENING);
    let w = (1.0 - e2 * sin * sin).sqrt();
    let (across, along) = (SEMI_MAJOR_M / w, SEMI_MAJOR_M * (1.0 - e2) / (w * w * w));
    [across * cos * (place.1 - origin.1).to_radians(), along * (place.0 - origin.0).to_radians()]
}
