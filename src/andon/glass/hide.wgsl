// What glass leaves of a picture of what is behind it, blended as 1 − coverage.

@group(0) @binding(0) var sizes: texture_2d<f32>;

@fragment fn hide(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  return vec4f(textureLoad(sizes, vec2i(pixel.xy), 0).x);
}
