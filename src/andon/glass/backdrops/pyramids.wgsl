// Pictures sampled with a footprint, as pyramids.py has it. Level 0 lies at the corner of its
// rectangle, the coarser ones in a column to the right of it:
//
//   ┌───────────┬─────┐     heights that the levels are given: h' = h, rounded up to 2^levels, and
//   │ 0         │ 1   │     h'/2ᵏ below; level k ≥ 1 begins at row h'·(1 − 2^(1−k))
//   │           ├──┬──┘
//   └───────────┴──┘

// Footprints along the major axis.
const TAPS: i32 = 2;
// Pixels that a footprint covers, at most; its square. Those of rays along the picture are infinite.
const MOST: f32 = 1e5;
const MOST_SQUARED: f32 = MOST * MOST;

struct Pyramid {
  corner: vec2i,
  size: vec2i,
  levels: i32,
  // Columns, rows begin again at the border; else the last one goes on.
  repeats: vec2<bool>,
};

struct Axis {
  major: vec2f,
  // The diameter of a tap, squared.
  squared: f32,
};

// `whole`: columns are how far the place moves for a step of one pixel along each axis.
fn major_axis(whole: mat2x2f) -> Axis {
  let steps = mat2x2f(clamp(whole[0], vec2f(-MOST), vec2f(MOST)), clamp(whole[1], vec2f(-MOST), vec2f(MOST)));
  let xx = dot(vec2f(steps[0].x, steps[1].x), vec2f(steps[0].x, steps[1].x));
  let yy = dot(vec2f(steps[0].y, steps[1].y), vec2f(steps[0].y, steps[1].y));
  let xy = dot(vec2f(steps[0].x, steps[1].x), vec2f(steps[0].y, steps[1].y));
  let half = 0.5 * (xx - yy);
  let mean = 0.5 * (xx + yy);
  let spread = sqrt(half * half + xy * xy);
  let longest = min(mean + spread, MOST_SQUARED);
  let shortest = max(mean - spread, 0.0);
  let axis = select(vec2f(xy, spread - half), vec2f(spread + half, xy), xx >= yy);
  let major = axis * (sqrt(longest) * inverseSqrt(max(dot(axis, axis), 1e-30)));
  return Axis(major, max(longest / f32(TAPS * TAPS), shortest));
}

fn border(place: vec2i, size: vec2i, repeats: vec2<bool>) -> vec2i {
  let around = place - size * vec2i(floor(vec2f(place) / vec2f(size)));
  return select(clamp(place, vec2i(0), size - 1), around, repeats);
}

fn bilinear(picture: texture_2d<f32>, source: Pyramid, place: vec2f, level: i32) -> vec4f {
  let at = place * exp2(-f32(level)) - 0.5;
  let first = vec2i(floor(at));
  let share = at - floor(at);
  let size = (source.size + (vec2i(1) << vec2u(u32(level))) - 1) >> vec2u(u32(level));
  let high = (source.size.y + (1 << u32(source.levels)) - 1) >> u32(source.levels) << u32(source.levels);
  let row = high - ((high + high) >> u32(level));
  let corner = source.corner + select(vec2i(0), vec2i(source.size.x, row), level > 0);
  let a = corner + border(first, size, source.repeats);
  let b = corner + border(first + 1, size, source.repeats);
  let top = mix(textureLoad(picture, a, 0), textureLoad(picture, vec2i(b.x, a.y), 0), share.x);
  let bottom = mix(textureLoad(picture, vec2i(a.x, b.y), 0), textureLoad(picture, b, 0), share.x);
  return mix(top, bottom, share.y);
}

fn trilinear(picture: texture_2d<f32>, source: Pyramid, place: vec2f, level: f32) -> vec4f {
  let fine = i32(level);
  let low = bilinear(picture, source, place, fine);
  let high = bilinear(picture, source, place, min(fine + 1, source.levels));
  return mix(low, high, level - f32(fine));
}

// Mean of what a pixel covers. `place`: column and row, texel centres at +0.5.
fn sampled(picture: texture_2d<f32>, source: Pyramid, place: vec2f, steps: mat2x2f) -> vec4f {
  let axis = major_axis(steps);
  let level = clamp(0.5 * log2(max(axis.squared, 1.0)), 0.0, f32(source.levels));
  var sum = vec4f(0.0);
  for (var tap = 0; tap < TAPS; tap++) {
    let along = (f32(tap) + 0.5) / f32(TAPS) - 0.5;
    sum += trilinear(picture, source, place + along * axis.major, level);
  }
  return sum / f32(TAPS);
}
