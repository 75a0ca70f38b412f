// The tetrahedron around a point: zone, start, walk (lookup.py). All numbers of the volume's
// geometry lie in one picture of four floats a texel, whole numbers as floats: reading such a
// picture costs a software rasteriser a fraction of reading a buffer.

//!import andon/transport/probes/settings.wgsl

@group(0) @binding(2) var probe_data: texture_2d<f32>;

struct ProbeMix {
  probes: vec4i,
  weights: vec4f,
};

struct Walked {
  cell: i32,
  // −1: the cell holds the point; else the facet through which the walk has left the hull.
  exit: i32,
  weights: vec4f,
};

// Coordinates are negative below this; float32 leaves some 1e-6 of them in cells that are not
// slivers.
const PROBE_INSIDE: f32 = -1e-6;

fn datum(place: i32) -> vec4f {
  return textureLoad(probe_data, vec2i(place & 2047, place >> 11), 0);
}

// Lists of whole numbers, four a texel.
fn listed(first: i32, index: i32) -> i32 {
  return i32(datum(first + (index >> 2))[index & 3]);
}

fn zone_of(position: vec3f) -> i32 {
  if (PROBE_BOX_COUNT == 1) { return 0; }
  var best = 0;
  var least = 3e38;
  for (var i = 0; i < PROBE_BOX_COUNT; i++) {
    let low = datum(PROBE_BOXES + 2 * i);
    let high = datum(PROBE_BOXES + 2 * i + 1).xyz;
    let beyond = max(max(low.xyz - position, position - high), vec3f(0.0));
    let square = dot(beyond, beyond);
    best = select(best, i32(low.w), square < least);
    least = min(least, square);
  }
  return best;
}

// A tetrahedron; −1 − facet in a zone without volume.
fn walk_start(position: vec3f, zone: i32) -> i32 {
  let origin = datum(PROBE_ZONES + 3 * zone);
  let scale = datum(PROBE_ZONES + 3 * zone + 1).xyz;
  let shape = datum(PROBE_ZONES + 3 * zone + 2).xyz;
  let place = vec3i(clamp(floor((position - origin.xyz) * scale), vec3f(0.0), shape - 1.0));
  let index = place.x + i32(shape.x) * (place.y + i32(shape.y) * place.z);
  return listed(PROBE_STARTS, i32(origin.w) + index);
}

fn barycentric(cell: i32, position: vec3f) -> vec4f {
  let base = PROBE_CELLS + 5 * cell;
  let a = datum(base);
  let b = datum(base + 1);
  let c = datum(base + 2);
  let away = position - vec3f(a.w, b.w, c.w);
  let three = vec3f(dot(a.xyz, away), dot(b.xyz, away), dot(c.xyz, away));
  return vec4f(three, 1.0 - three.x - three.y - three.z);
}

fn smallest(v: vec4f) -> i32 {
  let low = min(min(v.x, v.y), min(v.z, v.w));
  return select(select(select(3, 2, v.z == low), 1, v.y == low), 0, v.x == low);
}

fn walk_cells(position: vec3f, start: i32) -> Walked {
  var cell = max(start, 0);
  // No cell, and no facet either, which are negative numbers here.
  var before = -3e38;
  // In a zone without volume, the facet where the walk on its facets begins.
  var exit = select(-1, -1 - start, start < 0);
  var weights = vec4f(0.25);
  let last = select(PROBE_CELL_STEPS, 0, start < 0);
  for (var step = 0; step < last; step++) {
    weights = barycentric(cell, position);
    let beyond = datum(PROBE_CELLS + 5 * cell + 3);
    // Whoever came through a face lies on this side of it, whatever rounding says.
    let judged = select(weights, vec4f(1.0), beyond == vec4f(before));
    let inner = select(vec4f(1.0), judged, beyond >= vec4f(0.0));
    let through = smallest(inner);
    let leaving = smallest(judged);
    let goes = inner[through] < PROBE_INSIDE;
    if (!goes) {
      exit = select(-1, -1 - i32(beyond[leaving]), judged[leaving] < PROBE_INSIDE);
      break;
    }
    before = f32(cell);
    cell = i32(beyond[through]);
  }
  return Walked(cell, exit, weights);
}
