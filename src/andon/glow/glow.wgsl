// The glow along one axis: pixels → cells → filtered cells → pixels (plan.py has the layout).
//
// textureLoad throughout. Taps beyond the picture have weight 0; cells without light, margins
// included, are drawn as zeros before they are read.

//!import andon/glow/axis.wgsl

@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var bodies: texture_2d<f32>;

// NaN and negative light compare false and become 0; infinity becomes the limit.
fn usable(light: vec3f) -> vec3f {
  return select(vec3f(0.0), min(light, vec3f(BODY_LIMIT)), light > vec3f(0.0));
}

// Tap k of 3r − 2 of the discrete quadratic B-spline, times r³: the numbers of ways in which three
// numbers below r sum to k.
fn spline(k: i32) -> f32 {
  let r = f32(REDUCTION);
  let d = abs(f32(k) - 1.5 * (r - 1.0));
  let rim = 1.5 * r - d;
  return select(0.5 * (rim * rim - 0.25), 0.25 * (3.0 * r * r + 1.0) - d * d, 2.0 * d <= r);
}

// Mean light of a cell.
@fragment fn reduce(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  let first = (dot(place, AXIS) - ORIGIN - 1) * REDUCTION + 1;
  let start = place - AXIS * (dot(place, AXIS) - first);
  let r = f32(REDUCTION);
  var sum = vec3f(0.0);
  for (var k = 0; k < 3 * REDUCTION - 2; k++) {
    let inside = first + k >= 0 && first + k < LENGTH;
    sum += select(0.0, spline(k), inside) * usable(textureLoad(source, start + AXIS * k, 0).xyz);
  }
  return vec4f(sum / r / r / r, 0.0);
}

@fragment fn filter_cells(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  var sum = TAPS[0] * textureLoad(source, place, 0).xyz;
  for (var k = 1; k <= RADIUS; k++) {
    let pair = textureLoad(source, place + AXIS * k, 0) + textureLoad(source, place - AXIS * k, 0);
    sum += TAPS[k] * pair.xyz;
  }
  return vec4f(sum, 0.0);
}

// The three cells whose splines reach a pixel; the middle one takes what the others leave of 1.
fn expanded(pixel: vec2i) -> vec3f {
  let along = dot(pixel, AXIS);
  let cell = along / REDUCTION;
  let phase = along - cell * REDUCTION;
  let back = REDUCTION - 1 - phase;
  let scale = 0.5 / f32(REDUCTION) / f32(REDUCTION);
  let after = f32(phase) * f32(phase + 1) * scale;
  let before = f32(back) * f32(back + 1) * scale;
  let middle = pixel + AXIS * (ORIGIN + cell - along);
  return before * textureLoad(source, middle - AXIS, 0).xyz
    + (1.0 - before - after) * textureLoad(source, middle, 0).xyz
    + after * textureLoad(source, middle + AXIS, 0).xyz;
}

@fragment fn expand(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  return vec4f(expanded(vec2i(pixel.xy)), 0.0);
}

// What is blended onto the picture: may be negative, alpha stays as it is.
@fragment fn scatter(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  return vec4f(FRACTION * (expanded(place) - usable(textureLoad(bodies, place, 0).xyz)), 0.0);
}
