// The layers at half, a quarter, … of the size: premultiplied means, then images without holes.
//
//   reduce   level l − 1 → l   weights 1 3 3 1 along each axis: a point stays where it is
//   fill     level l + 1 → l   images divided by coverage; where there is none, the coarser level's

//!import andon/glass/defocus/kernel.wgsl

@group(0) @binding(0) var linear: sampler;
@group(0) @binding(1) var refracted: texture_2d<f32>;
@group(0) @binding(2) var surface: texture_2d<f32>;
@group(0) @binding(3) var reflected: texture_2d<f32>;
@group(0) @binding(4) var sizes: texture_2d<f32>;
@group(0) @binding(5) var coarse_refracted: texture_2d<f32>;
@group(0) @binding(6) var coarse_reflected: texture_2d<f32>;
@group(0) @binding(7) var coarse_sizes: texture_2d<f32>;

struct Level {
  @location(0) refracted: vec4f,
  @location(1) reflected: vec4f,
  @location(2) sizes: vec4f,
  @location(3) surface: vec4f,
}

// Four samples between pixels are the sixteen weights.
fn mean(source: texture_2d<f32>, texel: vec2f, is_read: bool) -> vec4f {
  let size = vec2f(textureDimensions(source));
  if (!is_read) {
    return vec4f(0.0);
  }
  var sum = vec4f(0.0);
  for (var k = 0; k < 4; k++) {
    let offset = vec2f(f32(k & 1), f32(k >> 1)) * 1.5 - 0.75;
    sum += textureSampleLevel(source, linear, (2.0 * texel + offset) / size, 0.0);
  }
  return 0.25 * sum;
}

@fragment fn reduce(@builtin(position) texel: vec4f) -> Level {
  return Level(
    mean(refracted, texel.xy, BLURS.x || BLURS.y), mean(reflected, texel.xy, BLURS.z || BLURS.y),
    mean(sizes, texel.xy, true), mean(surface, texel.xy, BLURS.y),
  );
}

struct Filled {
  @location(0) refracted: vec4f,
  @location(1) reflected: vec4f,
  @location(2) sizes: vec4f,
}

@fragment fn fill(@builtin(position) texel: vec4f) -> Filled {
  let place = vec2i(texel.xy);
  let own = textureLoad(sizes, place, 0);
  let covered = own.x > 0.0;
  let share = select(1.0, own.x, covered);
  let at = 0.5 * texel.xy / vec2f(textureDimensions(coarse_sizes));
  let beyond = textureSampleLevel(coarse_sizes, linear, at, 0.0);
  return Filled(
    select(textureSampleLevel(coarse_refracted, linear, at, 0.0),
           textureLoad(refracted, place, 0) / share, covered),
    select(textureSampleLevel(coarse_reflected, linear, at, 0.0),
           textureLoad(reflected, place, 0) / share, covered),
    vec4f(own.x, select(beyond.y, own.y / share, covered), 0.0, 0.0),
  );
}
