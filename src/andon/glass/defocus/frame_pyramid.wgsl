// The frame with its vergences at full, half and a quarter of the size; frame.wgsl has the order.

//!import andon/glass/defocus/frame_depth.wgsl

@group(0) @binding(0) var gbuffer: texture_2d<u32>;

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

// Smallest and largest diameter near a texel of a quarter of the size: three rounds over 3×3 texels
// that are 1, 3 and 4 apart are 17×17, as far as the largest disc reaches.
@fragment fn range(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let end = vec2i(textureDimensions(light)) - 1;
  let per_dioptre = frame.pupil_m / sqrt(pixel_steradians(4.0 * texel.xy));
  var found = vec2f(1e4, 0.0);
  for (var k = 0; k < 9; k++) {
    let place = clamp(vec2i(texel.xy) + APART * vec2i(k % 3 - 1, k / 3 - 1), vec2i(0), end);
    let tap = textureLoad(light, place, 0);
    let ends = select(tap.xy, vec2f(diameter_of(tap.w, per_dioptre)), APART == 1);
    found = vec2f(min(found.x, ends.x), max(found.y, ends.y));
  }
  return vec4f(found, 0.0, 0.0);
}
