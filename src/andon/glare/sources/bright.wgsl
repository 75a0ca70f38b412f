// Pixels that belong to sources of glare: 1 where the luminance is above the threshold.

//!import andon/glare/sources/threshold.wgsl

@group(0) @binding(0) var light: texture_2d<f32>;

@fragment fn bright(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let value = dot(textureLoad(light, vec2i(pixel.xy), 0).rgb, vec3f(0.2126, 0.7152, 0.0722));
  // NaN compares false.
  return vec4f(select(0.0, 1.0, value > THRESHOLD));
}
