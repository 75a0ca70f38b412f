// The paper's Gaussian along one axis of one level of a picture, and back to the finest level.

//!struct BlurRecord
//!import andon/glass/backdrops/pyramids.wgsl

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var<uniform> blur: BlurRecord;
// Weights, four a row: the middle one and those to one side.
@group(0) @binding(2) var<uniform> weights: array<vec4f, 8>;

fn texel(place: vec2i) -> vec4f {
  return textureLoad(picture, vec2i(blur.corner) + clamp(place, vec2i(0), vec2i(blur.size) - 1), 0);
}

@fragment fn along(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  let step = vec2i(blur.step);
  var sum = weights[0].x * texel(place);
  for (var k = 1; k <= i32(blur.radius); k++) {
    sum += weights[k >> 2u][k & 3] * (texel(place + step * k) + texel(place - step * k));
  }
  return sum;
}

// Bilinear from a coarser level, which is all of `picture`.
@fragment fn expanded(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let source = Pyramid(vec2i(0), vec2i(blur.size), 0, vec2<bool>(false));
  return bilinear(picture, source, pixel.xy * blur.scale, 0);
}
