// Irradiance from coefficients that are convolved with the cosine already: Σ c·Y(n), of bands 0, 1,
// 2 and, where the volume has it, 4; the cosine has no band 3. Seven texels hold nine coefficients
// of three channels: red 0…3, red 4…7, green, green, blue, blue, and the last of all three.

//!import andon/harmonics/harmonics.wgsl
//!import andon/transport/probes/settings.wgsl

@group(0) @binding(3) var probe_light: texture_2d<f32>;

fn light_texel(place: i32) -> vec4f {
  return textureLoad(probe_light, vec2i(place & 2047, place >> 11), 0);
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
