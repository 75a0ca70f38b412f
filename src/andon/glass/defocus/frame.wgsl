// The frame blurred by its own depth; frame.py has the rule. Discs are drawn at the level that they
// are large enough for, each level gives sums of light and of weight, and the last pass divides.
//
//   seen     light, and vergence, of each pixel of the frame
//   halve    means, weights 1 3 3 1, of texels at one depth: none lies between what is in front
//            and what is behind
//   sharpen  what halving and enlarging blur is taken away beforehand
//   spread   sums of the level's discs
//   lay      small discs at full size, and the levels' sums

//!import andon/glass/defocus/frame_depth.wgsl

// Radius of the disc for each diameter, in texels.
@group(0) @binding(3) var table: texture_2d<f32>;
@group(0) @binding(9) var ranges: texture_2d<f32>;
@group(0) @binding(5) var half_light: texture_2d<f32>;
@group(0) @binding(6) var half_sums: texture_2d<f32>;
@group(0) @binding(7) var quarter_light: texture_2d<f32>;
@group(0) @binding(8) var quarter_sums: texture_2d<f32>;

// Texels that this level's discs reach around a pixel; −1 where none is this level's.
fn reach_at(pixel: vec2f, own_d: f32) -> i32 {
  let end = vec2i(textureDimensions(ranges)) - 1;
  let ends = textureLoad(ranges, min(vec2i(0.25 * pixel), end), 0).xy;
  let low = min(ends.x, own_d);
  let high = min(max(ends.y, own_d), LAST.y);
  return select(min(i32(0.5 * high / TEXEL + 1.0), REACH), -1, low >= LAST.y || high <= FIRST.x);
}

// Share of a disc that is this level's.
fn share_of(d: f32) -> f32 {
  return smoothstep(FIRST.x, FIRST.y, d) * (1.0 - smoothstep(LAST.x, LAST.y, d));
}

// Sums over `source` around a texel that sees `own`, of discs that belong to this level.
fn sums(source: texture_2d<f32>, place: vec2i, own: f32, per_dioptre: f32) -> vec4f {
  let end = vec2i(textureDimensions(source)) - 1;
  let own_d = diameter_of(own, per_dioptre);
  var total = vec4f(0.0);
  let reach = reach_at((vec2f(place) + 0.5) * TEXEL, own_d);
  for (var y = -reach; y <= reach; y++) {
    let columns = i32(sqrt(max((f32(reach) + 0.5) * (f32(reach) + 0.5) - f32(y * y), 0.0)));
    for (var x = -columns; x <= columns; x++) {
      let tap = textureLoad(source, clamp(place + vec2i(x, y), vec2i(0), end), 0);
      let d = select(own_d, diameter_of(tap.w, per_dioptre), tap.w > own);
      let fitted = textureLoad(table, vec2i(i32(d / TEXEL * STEPS + 0.5), 0), 0).x;
      let radius = max(select(fitted, 0.5, d < 1.0), 0.5);
      let edge = saturate(radius + 0.5 - sqrt(f32(x * x + y * y)));
      let w = edge * share_of(d) / (PI * radius * radius);
      total += w * vec4f(tap.xyz, 1.0);
    }
  }
  return total;
}

@fragment fn spread(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  let pixel_radians = sqrt(pixel_steradians(texel.xy * TEXEL));
  return sums(light, place, textureLoad(light, place, 0).w, frame.pupil_m / pixel_radians);
}

// Sums of a coarser level at a pixel, from those of its texels that are at the pixel's depth.
fn enlarged(
  depths: texture_2d<f32>, parts: texture_2d<f32>, at: vec2f, own: f32, per_dioptre: f32,
) -> vec4f {
  let end = vec2i(textureDimensions(parts)) - 1;
  let first = floor(at - 0.5);
  let share = at - 0.5 - first;
  var total = vec4f(0.0);
  var weights = 1e-20;
  for (var k = 0; k < 4; k++) {
    let step = vec2i(k & 1, k >> 1u);
    let place = clamp(vec2i(first) + step, vec2i(0), end);
    let off = (textureLoad(depths, place, 0).w - own) * per_dioptre;
    let linear = select(1.0 - share.x, share.x, step.x == 1) * select(1.0 - share.y, share.y, step.y == 1);
    let w = linear * alike(off);
    total += w * textureLoad(parts, place, 0);
    weights += w;
  }
  // None of the four is at the pixel's depth: those around them.
  let rounds = select(0, 36, weights < 0.02);
  for (var k = 0; k < rounds; k++) {
    let place = clamp(vec2i(first) + vec2i(k % 6, k / 6) - 2, vec2i(0), end);
    let off = (textureLoad(depths, place, 0).w - own) * per_dioptre;
    let away = vec2f(place) + 0.5 - at;
    let w = alike(off) / (1.0 + dot(away, away) * dot(away, away));
    total += w * textureLoad(parts, place, 0);
    weights += w;
  }
  return total / weights;
}

@fragment fn lay(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  let own = textureLoad(light, place, 0).w;
  let per_dioptre = frame.pupil_m / sqrt(pixel_steradians(pixel.xy));
  var total = sums(light, place, own, per_dioptre);
  total += enlarged(half_light, half_sums, 0.5 * pixel.xy, own, per_dioptre);
  total += enlarged(quarter_light, quarter_sums, 0.25 * pixel.xy, own, per_dioptre);
  return vec4f(max(total.xyz, vec3f(0.0)) / max(total.w, 1e-6), 1.0);
}
