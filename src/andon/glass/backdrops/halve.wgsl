// One level of the frame's pyramid from the one before: means of 2×2 texels.

//!import andon/glass/backdrops/halved.wgsl

@group(0) @binding(0) var levels: texture_2d<f32>;

fn texel(place: vec2i) -> vec4f {
  return textureLoad(levels, CORNER + min(place, LAST), 0);
}

@fragment fn halve(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = 2 * vec2i(pixel.xy);
  let top = texel(place) + texel(place + vec2i(1, 0));
  return 0.25 * (top + texel(place + vec2i(0, 1)) + texel(place + 1));
}
