// Irradiance from coefficients that are convolved with the cosine already: Σ c·Y(n), of bands 0, 1,
// 2 and, where the volume has it, 4; the cosine has no band 3. Seven texels hold nine coefficients of three channels:
// red 0…3, red 4…7, green, green, blue, blue, and the last of all three.

//!import andon/transport/probes/settings.wgsl

@group(0) @binding(3) var probe_light: texture_2d<f32>;

struct NineTerms {
  a: vec4f,
  b: vec4f,
  c: f32,
};

fn light_texel(place: i32) -> vec4f {
  return textureLoad(probe_light, vec2i(place & 2047, place >> 11), 0);
}

// √(1/4π); √(3/4π); √(15/4π), √(5/16π): andon.harmonics.basis.
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

// √(35/16π), √(35/32π), √(5/16π), √(5/32π), √(9/256π) times whole numbers.
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

fn nine(first: i32, terms: NineTerms) -> vec3f {
  let low = vec3f(
    dot(light_texel(first), terms.a),
    dot(light_texel(first + 2), terms.a),
    dot(light_texel(first + 4), terms.a),
  );
  let high = vec3f(
    dot(light_texel(first + 1), terms.b),
    dot(light_texel(first + 3), terms.b),
    dot(light_texel(first + 5), terms.b),
  );
  return low + high + light_texel(first + 6).xyz * terms.c;
}

// Illuminance in lux by the coefficients of one row, on a surface that faces n; maybe negative.
fn irradiance(row: i32, n: vec3f) -> vec3f {
  let lux = nine(PROBE_TERMS * row, low_terms(n));
  if (PROBE_TERMS == 7) { return lux; }
  return lux + nine(PROBE_TERMS * row + 7, high_terms(n));
}
