// Inverse functions, by polynomials that are least in their greatest error (fitted for this file;
// tests/direct/test_area_parity.py holds them against NumPy).

//!import andon/gpu/pi.wgsl
const TINY: f32 = 1e-30;

// acos(x)/√(1 − x) for 0 ≤ x ≤ 1, relative error 1.5e-8: small angles keep all their digits.
fn acos_over_root(x: f32) -> f32 {
  var p = fma(x, -0.00125345648, 0.00663861634);
  p = fma(x, p, -0.0170450993);
  p = fma(x, p, 0.0308627496);
  p = fma(x, p, -0.0501641878);
  p = fma(x, p, 0.0889773121);
  p = fma(x, p, -0.214598697);
  return fma(x, p, 1.5707963);
}

// acos(x), consistent with √((1 − x)·(1 + x)) to the last digits.
fn angle_of_cosine(x: f32) -> f32 {
  let near = sqrt(1.0 - abs(x)) * acos_over_root(abs(x));
  return select(near, PI - near, x < 0.0);
}

// (atan z − z)/z for |z| ≤ 1 as a function of z², error 1.5e-8.
fn atan_excess(square: f32) -> f32 {
  var p = fma(square, 0.00297458896, -0.0165811784);
  p = fma(square, p, 0.0435535303);
  p = fma(square, p, -0.0758057738);
  p = fma(square, p, 0.106789399);
  p = fma(square, p, -0.14214209);
  p = fma(square, p, 0.199941372);
  return square * fma(square, p, -0.33333167);
}

// The angle of (x, y), −π…π; 0 of the origin. Of small ones all digits.
fn angle_of(y: f32, x: f32) -> f32 {
  let long = max(abs(x), abs(y));
  let z = min(abs(x), abs(y)) / max(long, TINY);
  let low = fma(z, atan_excess(z * z), z);
  let steep = select(low, 0.5 * PI - low, abs(y) > abs(x));
  let whole = select(steep, PI - steep, x < 0.0);
  return select(whole, -whole, y < 0.0);
}

// angle_of(y, x)/y, also for y = 0 where x > 0.
fn angle_over(y: f32, x: f32) -> f32 {
  let level = abs(y) <= x && x > 0.0;
  let z = y / select(1.0, x, level);
  let steep = angle_of(y, x) / select(1.0, y, abs(y) > TINY);
  return select(steep, (1.0 + atan_excess(z * z)) / select(1.0, x, level), level);
}

// atanh(z)/z for |z| < 1: ⅓ + z²/5 + … below a third, where log((1+z)/(1−z)) would round.
fn atanh_over(z: f32) -> f32 {
  let s = z * z;
  var p = fma(s, 0.0666666667, 0.0769230769);
  p = fma(s, p, 0.0909090909);
  p = fma(s, p, 0.111111111);
  p = fma(s, p, 0.142857143);
  p = fma(s, p, 0.2);
  p = fma(s, p, 0.333333333);
  let held = clamp(z, -0.9999999, 0.9999999);
  let steep = 0.5 * log((1.0 + held) / (1.0 - held)) / select(1.0, held, abs(held) > 0.1);
  return select(steep, fma(s, p, 1.0), s < 0.1111);
}

// a/b, and 0 where b is (almost) 0; b ≥ 0.
fn over(a: f32, b: f32) -> f32 {
  return select(0.0, a / max(b, TINY), b > TINY);
}
