// Bands 0, 1, 2 and 4 of the basis as andon.harmonics has them: order L00, L1−1, L10, L11, L2−2, …,
// no Condon–Shortley sign, world axes. n is a unit vector. The cosine has no band 3.

// Nine functions: the first four, the next four and the last.
struct NineTerms {
  a: vec4f,
  b: vec4f,
  c: f32,
};

// Bands 0 to 2: √(1/4π); √(3/4π); √(15/4π), √(5/16π).
fn low_terms(n: vec3f) -> NineTerms {
  return NineTerms(
    vec4f(0.282094791773878, 0.488602511902920 * n.yzx),
    vec4f(
      1.092548430592079 * n.x * n.y,
      1.092548430592079 * n.y * n.z,
      0.315391565252520 * (3.0 * n.z * n.z - 1.0),
      1.092548430592079 * n.x * n.z,
    ),
    0.546274215296040 * (n.x * n.x - n.y * n.y),
  );
}

// Band 4: √(35/16π), √(35/32π), √(5/16π), √(5/32π), √(9/256π) times whole numbers.
fn high_terms(n: vec3f) -> NineTerms {
  let s = n * n;
  return NineTerms(
    vec4f(
      2.503342941796705 * n.x * n.y * (s.x - s.y),
      1.770130769779930 * n.y * n.z * (3.0 * s.x - s.y),
      0.946174695757560 * n.x * n.y * (7.0 * s.z - 1.0),
      0.669046543557289 * n.y * n.z * (7.0 * s.z - 3.0),
    ),
    vec4f(
      0.105785546915204 * (35.0 * s.z * s.z - 30.0 * s.z + 3.0),
      0.669046543557289 * n.x * n.z * (7.0 * s.z - 3.0),
      0.473087347878780 * (s.x - s.y) * (7.0 * s.z - 1.0),
      1.770130769779930 * n.x * n.z * (s.x - 3.0 * s.y),
    ),
    0.625835735449176 * (s.x * (s.x - 3.0 * s.y) - s.y * (3.0 * s.x - s.y)),
  );
}
