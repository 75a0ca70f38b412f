// Walls hide probes: visibility.py and hidden.py.

//!import andon/gpu/octahedral.wgsl
//!import andon/transport/probes/hull.wgsl
//!import andon/transport/probes/irradiance.wgsl

// Mean distance, and spread within the texel, of all probes: tiles with a margin of one texel that
// repeats what lies across the edge.
@group(0) @binding(4) var probe_distances: texture_2d<f32>;

const PROBE_CUT: f32 = 0.5;
const PROBE_LIFT: f32 = 0.1;
const PROBE_LEAST_SPREAD: f32 = 1e-3;
const PROBE_ENOUGH: f32 = 0.05;
const PROBE_LEAST: f32 = 1e-5;

// How much a point may believe a probe: 0 hidden … 1 seen.
fn seen(probe: i32, position: vec3f, normal: vec3f) -> f32 {
  var reach = position - datum(PROBE_PLACES + 4 * probe).xyz;
  reach += PROBE_LIFT * length(reach) * normal;
  let distance = length(reach);
  let direction = select(vec3f(0.0, 0.0, 1.0), reach, distance > 0.0);
  let at = (octahedral_square(direction) + 1.0) * (0.5 * PROBE_SIDE) + 0.5;
  let first = floor(at);
  let part = at - first;
  let tile = vec2i(probe % PROBE_TILES, probe / PROBE_TILES) * (i32(PROBE_SIDE) + 2);
  let corner = tile + vec2i(first);
  let a = textureLoad(probe_distances, corner, 0).xy;
  let b = textureLoad(probe_distances, corner + vec2i(1, 0), 0).xy;
  let c = textureLoad(probe_distances, corner + vec2i(0, 1), 0).xy;
  let d = textureLoad(probe_distances, corner + vec2i(1, 1), 0).xy;
  let weights = vec4f((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y);
  let means = vec4f(a.x, b.x, c.x, d.x);
  let mean = dot(weights, means);
  let spread = dot(weights, vec4f(a.y, b.y, c.y, d.y) + (means - mean) * (means - mean));
  let behind = max(min(distance, PROBE_FAR_M) - mean, 0.0);
  let least = PROBE_LEAST_SPREAD * mean;
  let variance = max(max(spread, least * least), 1e-12);
  let share = max((variance / (variance + behind * behind) - PROBE_CUT) / (1.0 - PROBE_CUT), 0.0);
  return share * share * share;
}

// Light (xyz, times the weight) and weight (w) that the neighbours of a hidden probe give instead.
fn lent(probe: i32, position: vec3f, normal: vec3f) -> vec4f {
  var total = 0.0;
  var light = vec4f(0.0);
  for (var k = 0; k < 8; k++) {
    let near = listed(PROBE_PLACES + 4 * probe + 2, k);
    if (near < 0) { break; }
    let away = position - datum(PROBE_PLACES + 4 * near + 1).xyz;
    let closeness = 1.0 / max(dot(away, away), 1e-12);
    let weight = closeness * seen(near, position, normal);
    total += closeness;
    light += weight * vec4f(irradiance(near, normal), 1.0);
  }
  return light / max(total, 1e-30);
}

fn probe_lux(position: vec3f, normal: vec3f) -> vec3f {
  let mix = locate(position);
  var light = vec4f(0.0);
  var share = 0.0;
  for (var k = 0; k < 4; k++) {
    let own = mix.weights[k] * seen(mix.probes[k], position, normal);
    share += own;
    light += (own + PROBE_LEAST * mix.weights[k]) * vec4f(irradiance(mix.probes[k], normal), 1.0);
  }
  // As a loop whose end depends on the pixel, it costs one step where nobody needs it.
  let helped = max(1.0 - share / PROBE_ENOUGH, 0.0);
  let last = select(0, 4, helped > 0.0);
  for (var k = 0; k < last; k++) {
    light += helped * mix.weights[k] * lent(mix.probes[k], position, normal);
  }
  return max(light.xyz / light.w, vec3f(0.0));
}
