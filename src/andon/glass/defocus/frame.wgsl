// The frame blurred by its own depth; frame.py has the rule. Discs are drawn at the level that they
// are large enough for, each level gives sums of light and of weight, and the last pass divides.
//
//   seen     light, and vergence, of each pixel of the frame
//   halve    means, weights 1 3 3 1, of texels at one depth: none lies between what is in front
//            and what is behind
//   sharpen  what halving and enlarging blur is taken away beforehand
//   spread   sums of the level's discs
//   lay      small discs at full size, and the levels' sums

//!struct FrameRecord
//!import andon/gbuffer/gbuffer.wgsl
//!import andon/glass/defocus/frame_level.wgsl

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var<uniform> frame: FrameRecord;
// Radius of the disc for each diameter, in texels.
@group(0) @binding(3) var table: texture_2d<f32>;
@group(0) @binding(4) var light: texture_2d<f32>;
@group(0) @binding(5) var half_light: texture_2d<f32>;
@group(0) @binding(6) var half_sums: texture_2d<f32>;
@group(0) @binding(7) var quarter_light: texture_2d<f32>;
@group(0) @binding(8) var quarter_sums: texture_2d<f32>;

@fragment fn seen(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  let packed = textureLoad(gbuffer, place, 0);
  let distance = bitcast<f32>(packed.x) * length(world_ray(pixel.xy));
  let vergence = select(0.0, 1.0 / distance, (packed.w & VALID) != 0u);
  return vec4f(textureLoad(light, place, 0).xyz, vergence);
}

// Which of 2×2 texels a texel of the next level goes with: its vergence. On a slanted plane all are
// one; at an edge the nearer ones or the farther, whichever are more.
fn depth_of(depths: vec4f, per_dioptre: f32) -> f32 {
  let high = max(max(depths.x, depths.y), max(depths.z, depths.w));
  let low = min(min(depths.x, depths.y), min(depths.z, depths.w));
  let split = select(low, 0.5 * (high + low), (high - low) * per_dioptre > EDGE_PX);
  let nearer = select(vec4f(0.0), vec4f(1.0), depths >= vec4f(split));
  let kept = select(1.0 - nearer, nearer, dot(nearer, vec4f(1.0)) >= 2.0);
  return dot(kept, depths) / dot(kept, vec4f(1.0));
}

@fragment fn halve(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let end = vec2i(textureDimensions(light)) - 1;
  let first = 2 * vec2i(texel.xy);
  let per_dioptre = frame.pupil_m / sqrt(pixel_steradians(2.0 * TEXEL * texel.xy));
  let own = depth_of(vec4f(
    textureLoad(light, min(first, end), 0).w,
    textureLoad(light, min(first + vec2i(1, 0), end), 0).w,
    textureLoad(light, min(first + vec2i(0, 1), end), 0).w,
    textureLoad(light, min(first + vec2i(1, 1), end), 0).w,
  ), per_dioptre);
  var sum = vec4f(0.0);
  for (var k = 0; k < 16; k++) {
    let step = vec2i(k & 3, k >> 2u) - 1;
    let tap = textureLoad(light, clamp(first + step, vec2i(0), end), 0);
    let inner = vec2f(select(1.0, 3.0, (step.x & 2) == 0), select(1.0, 3.0, (step.y & 2) == 0));
    sum += inner.x * inner.y * alike((tap.w - own) * per_dioptre) * vec4f(tap.xyz, 1.0);
  }
  return vec4f(sum.xyz / sum.w, own);
}

// Takes away the second moment that halving and enlarging add, from what is at one depth.
@fragment fn sharpen(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let end = vec2i(textureDimensions(light)) - 1;
  let place = vec2i(texel.xy);
  let per_dioptre = frame.pupil_m / sqrt(pixel_steradians(TEXEL * texel.xy));
  let own = textureLoad(light, place, 0);
  var sum = own.xyz;
  for (var k = 0; k < 4; k++) {
    let step = (1 - (k & 2)) * vec2i(k & 1, 1 - (k & 1));
    let tap = textureLoad(light, clamp(place + step, vec2i(0), end), 0);
    sum += HALF_SHARPENING * alike((tap.w - own.w) * per_dioptre) * (own.xyz - tap.xyz);
  }
  return vec4f(sum, own.w);
}

// Blurs that differ by more than this within a texel are of two things, px.
const EDGE_PX: f32 = 2.0;

// Diameter in pixels of what has this vergence.
fn diameter_of(vergence: f32, per_dioptre: f32) -> f32 {
  return min(abs(vergence - frame.focus_dioptres) * per_dioptre, frame.largest_px);
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
  for (var y = -REACH; y <= REACH; y++) {
    for (var x = -REACH; x <= REACH; x++) {
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

// Weight of what differs by `off` pixels of blur: near 1 on slanted planes, next to none over edges.
fn alike(off: f32) -> f32 {
  let squared = off * off / (EDGE_PX * EDGE_PX);
  return 1.0 / (1.0 + squared * squared * squared);
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
