// Irradiance of bands 0 to 2 as andon.harmonics has them: order L00, L1−1, L10, L11, L2−2, …, no
// Condon–Shortley sign, world axes. Source: Ramamoorthi & Hanrahan 2001, equations 3 and 7.

// √(1/4π), √(3/4π), √(15/4π), √(5/16π)
const HARMONIC_0: f32 = 0.28209479177387814;
const HARMONIC_1: f32 = 0.4886025119029199;
const HARMONIC_2: f32 = 1.0925484305920792;
const HARMONIC_20: f32 = 0.31539156525252005;

// Σ light·Y(n). `light` is convolved with the cosine (`convolved`), in lux, so the sum is the
// irradiance of a surface that faces the unit vector n: E, not E/π; below zero where it rings.
fn irradiance_l2(light: array<vec3f, 9>, n: vec3f) -> vec3f {
  let band_1 = light[1] * n.y + light[2] * n.z + light[3] * n.x;
  let mixed = light[4] * (n.x * n.y) + light[5] * (n.y * n.z) + light[7] * (n.x * n.z)
    + light[8] * (0.5 * (n.x * n.x - n.y * n.y));
  return HARMONIC_0 * light[0] + HARMONIC_1 * band_1 + HARMONIC_2 * mixed
    + HARMONIC_20 * (3.0 * n.z * n.z - 1.0) * light[6];
}
