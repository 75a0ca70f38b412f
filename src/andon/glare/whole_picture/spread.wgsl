// A level of the pyramid: √w·P(√w·D) of one rung or two, and the veil of the coarser ones on top.

//!import andon/glare/whole_picture/numbers.wgsl

// D with √w of the first rung in alpha; or √w·D of it filtered along x, with √w.
@group(0) @binding(0) var cells: texture_2d<f32>;
// √w of the second rung; or √w·D of that filtered along x, with √w.
@group(0) @binding(1) var second: texture_2d<f32>;
// The next level's veil.
@group(0) @binding(2) var above: texture_2d<f32>;
// Veil of the far light, and one more than the place in it of each cell, 0: none.
@group(0) @binding(3) var far: texture_2d<f32>;
@group(0) @binding(4) var far_places: texture_2d<u32>;

// 0 beyond the border.
fn cell_at(map: texture_2d<f32>, at: vec2i) -> vec4f {
  let end = vec2i(textureDimensions(map)) - 1;
  let inside = all(at >= vec2i(0)) && all(at <= end);
  return select(vec4f(0.0), textureLoad(map, clamp(at, vec2i(0), end), 0), inside);
}

fn weighted(at: vec2i) -> vec3f {
  let light = cell_at(cells, at);
  return light.w * light.xyz;
}

@fragment fn filtered_x(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  let own = cell_at(cells, place);
  var sum = TAPS[0] * own.w * own.xyz;
  for (var k = 1; k <= RADIUS; k++) {
    sum += TAPS[k] * (weighted(place + vec2i(k, 0)) + weighted(place - vec2i(k, 0)));
  }
  return vec4f(sum, own.w);
}

fn weighted_second(at: vec2i) -> vec3f {
  return cell_at(second, at).x * cell_at(cells, at).xyz;
}

@fragment fn filtered_x_second(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  var sum = WIDE_TAPS[0] * weighted_second(place);
  for (var k = 1; k <= WIDE_RADIUS; k++) {
    let step = vec2i(k, 0);
    sum += WIDE_TAPS[k] * (weighted_second(place + step) + weighted_second(place - step));
  }
  return vec4f(sum, cell_at(second, place).x);
}

fn filtered(place: vec2i) -> vec3f {
  let own = cell_at(cells, place);
  var sum = TAPS[0] * own.xyz;
  for (var k = 1; k <= RADIUS; k++) {
    let step = vec2i(0, k);
    sum += TAPS[k] * (cell_at(cells, place + step).xyz + cell_at(cells, place - step).xyz);
  }
  return own.w * sum;
}

fn filtered_second(place: vec2i) -> vec3f {
  let own = cell_at(second, place);
  var sum = WIDE_TAPS[0] * own.xyz;
  for (var k = 1; k <= WIDE_RADIUS; k++) {
    let step = vec2i(0, k);
    sum += WIDE_TAPS[k] * (cell_at(second, place + step).xyz + cell_at(second, place - step).xyz);
  }
  return own.w * sum;
}

// [3 1]/4 along each axis.
fn expanded(place: vec2i) -> vec3f {
  let end = vec2i(textureDimensions(above)) - 1;
  // Shifted by an even number, so that halves are rounded down beyond the margin as well.
  let own = ((place - MARGIN + 64) >> vec2u(1u)) - 32 + MARGIN;
  let other = clamp(own + 2 * ((place - MARGIN) & vec2i(1)) - 1, vec2i(0), end);
  return (9.0 * textureLoad(above, own, 0).xyz + textureLoad(above, other, 0).xyz
    + 3.0 * (textureLoad(above, vec2i(other.x, own.y), 0).xyz
      + textureLoad(above, vec2i(own.x, other.y), 0).xyz)) / 16.0;
}

fn far_light(place: vec2i) -> vec3f {
  let known = i32(textureLoad(far_places, place, 0).x) - 1;
  let at = max(known, 0);
  let columns = i32(textureDimensions(far).x);
  let light = textureLoad(far, vec2i(at % columns, at / columns), 0).xyz;
  return select(vec3f(0.0), light, known >= 0);
}

// The constants leave only what the level has.
@fragment fn accumulated(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  var sum = vec3f(0.0);
  if (RUNGS > 0) {
    sum += filtered(place);
  }
  if (RUNGS > 1) {
    sum += filtered_second(place);
  }
  if (HAS_ABOVE) {
    sum += expanded(place);
  }
  if (HAS_FAR) {
    sum += far_light(place);
  }
  return vec4f(sum, 0.0);
}
