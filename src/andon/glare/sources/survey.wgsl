// Tiles of 8×8 pixels: mean and peak of the photometric luminance, as survey.py has them.

//!import andon/gpu/photometric.wgsl

@group(0) @binding(0) var light: texture_2d<f32>;

const SIDE: i32 = 8;

@fragment fn survey(@builtin(position) tile: vec4f) -> @location(0) vec4f {
  let first = vec2i(tile.xy) * SIDE;
  let end = min(first + SIDE, vec2i(textureDimensions(light)));
  var sum = 0.0;
  var peak = 0.0;
  for (var y = first.y; y < end.y; y++) {
    for (var x = first.x; x < end.x; x++) {
      let value = photometric(textureLoad(light, vec2i(x, y), 0).rgb);
      // NaN and negative light compare false and count as 0; infinity is what a half float holds.
      let usable = select(0.0, min(value, 65504.0), value > 0.0);
      sum += usable;
      peak = max(peak, usable);
    }
  }
  let size = end - first;
  return vec4f(sum / f32(size.x * size.y), peak, 0.0, 0.0);
}
