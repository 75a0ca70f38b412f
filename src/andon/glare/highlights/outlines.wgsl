// Lamps' outlines, and what is mirrored of them: outlines.py and _of_an_area of reference.py.

//!import andon/glare/highlights/lobes.wgsl
//!import andon/transport/direct/direct.wgsl

const CORNERS: i32 = 16;
// √(2π/(16·sin(2π/16))): a polygon of the same area.
const SAME_AREA: f32 = 1.0130286;

// What an outline holds of a lobe, edge by edge; of GGX also the mean of `weight` over its corners.
struct Held {
  light: vec3f,
  value: vec3f,
  lobe: f32,
  count: f32,
};

// Slopes of the lamp's middle in xy, and 1 in z where the lobe's middle is far from them.
fn lamp_middle(facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  let seen = half_slopes(facet, above_horizon(facet, reach));
  let sine = radius / max(length(reach), radius);
  let size = sine / (2.0 * max(seen.w, 0.05) * seen.z * seen.z * min(facet.alpha.x, facet.alpha.y));
  return vec3f(seen.xy, select(0.0, 1.0, length(seen.xy) > FAR * size));
}

fn with_edge(held: Held, facet: Facet, middle: vec3f, start: vec3f, end: vec3f, light: vec3f) -> Held {
  var sum = held;
  let first = above_horizon(facet, start);
  let last = above_horizon(facet, end);
  if (facet.kind == PHONG) {
    sum.light += light * phong_edge_share(phong_plane(facet, first), phong_plane(facet, last), facet.exponent);
    return sum;
  }
  let p = half_slopes(facet, first);
  let q = half_slopes(facet, last);
  let share = select(edge_share(p.xy, q.xy), fan_share(p.xy, q.xy, middle.xy), middle.z > 0.5);
  let lobe = ggx_slopes(p.xy);
  sum.light += light * share;
  sum.value += weight(facet, first, p) * lobe;
  sum.lobe += lobe;
  sum.count += 1.0;
  return sum;
}

fn nearest_to_mirror(facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  let distance = max(length(reach), 1e-9);
  let axis = reach / distance;
  let sine = min(radius / distance, 0.999);
  let cosine = sqrt(1.0 - sine * sine);
  let along = dot(facet.mirror, axis);
  let across = facet.mirror - along * axis;
  let bounded = cosine * axis + sine / max(length(across), 1e-9) * across;
  let closest = select(bounded, facet.mirror, along > cosine);
  let rough = sqrt(facet.alpha.x * facet.alpha.y);
  return normalize(above_horizon(facet, closest + (axis - closest) * rough));
}

fn held_light(held: Held, facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  // Lifted to the horizon, an outline straight below would go all the way round it.
  let risen = select(0.0, 1.0, dot(facet.normal, reach) > -radius);
  if (facet.kind == PHONG) {
    return risen * abs(held.light) * facet.straight;
  }
  let near = nearest_to_mirror(facet, reach, radius);
  let seen = half_slopes(facet, near);
  let lobe = ggx_slopes(seen.xy);
  let own = weight(facet, near, seen) * lobe;
  let count = max(held.count, 1.0);
  return risen * abs(held.light) * (own + held.value / count) / (lobe + held.lobe / count);
}

// A closed outline of `CORNERS` corners of one luminance.
fn outline_highlight(facet: Facet, reach: vec3f, radius: f32, corners: array<vec3f, 16>) -> vec3f {
  let middle = lamp_middle(facet, reach, radius);
  var held = Held(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
  var around = corners;
  for (var i = 0; i < CORNERS; i++) {
    held = with_edge(held, facet, middle, around[i], around[(i + 1) & (CORNERS - 1)], vec3f(1.0));
  }
  return held_light(held, facet, reach, radius);
}

fn ball_highlight(facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  let distance = max(length(reach), 1e-9);
  let towards = reach / distance;
  let sine = min(radius / distance, 0.999);
  let wide = SAME_AREA * sine / sqrt(1.0 - sine * sine);
  let a = first_of_frame(towards);
  let b = second_of_frame(towards);
  var corners: array<vec3f, 16>;
  for (var i = 0; i < CORNERS; i++) {
    let turn = f32(i) * (2.0 * PI / f32(CORNERS));
    corners[i] = towards + wide * (cos(turn) * a + sin(turn) * b);
  }
  return outline_highlight(facet, reach, radius, corners);
}

fn disk_highlight(facet: Facet, lamp: i32, two_sided: f32) -> vec3f {
  let record = lamps[lamp];
  let reach = record.position - facet.position;
  let facing = -dot(reach, record.axis);
  let a = first_of_frame(record.axis);
  let b = second_of_frame(record.axis) * select(1.0, -1.0, facing > 0.0);
  var corners: array<vec3f, 16>;
  for (var i = 0; i < CORNERS; i++) {
    let turn = f32(i) * (2.0 * PI / f32(CORNERS));
    corners[i] = reach + SAME_AREA * record.radius_m * (cos(turn) * a + sin(turn) * b);
  }
  let light = outline_highlight(facet, reach, record.radius_m, corners);
  return select(vec3f(0.0), light * record.light, two_sided > 0.5 || facing > 0.0);
}

fn tube_corner(end: vec3f, axis: vec3f, radius: f32, way: f32, turn: f32) -> vec3f {
  let distance = max(length(end), 1e-9);
  let sight = end / distance;
  let leaning = axis - sight * dot(axis, sight);
  let along = leaning / max(length(leaning), 1e-9);
  let sine = min(radius / distance, 0.999);
  let wide = SAME_AREA * radius / sqrt(1.0 - sine * sine);
  return end + way * wide * (cos(turn) * along + sin(turn) * cross(sight, along));
}

fn tube_highlight(facet: Facet, lamp: i32) -> vec3f {
  let record = lamps[lamp];
  let ends = array<vec3f, 2>(record.right - facet.position, record.position - facet.position);
  let axis = record.right - record.position;
  var corners: array<vec3f, 16>;
  for (var i = 0; i < 8; i++) {
    let turn = -0.5 * PI + f32(i) * (PI / 7.0);
    corners[i] = tube_corner(ends[0], axis, record.radius_m, 1.0, turn);
    corners[8 + i] = tube_corner(ends[1], axis, record.radius_m, -1.0, turn);
  }
  let radius = 0.5 * length(axis) + record.radius_m;
  return record.light * outline_highlight(facet, 0.5 * (ends[0] + ends[1]), radius, corners);
}

// Polygons, meshes and pictures: `count` edges from `first` on, each in `parts`.
fn edges_highlight(facet: Facet, lamp: i32, first_edge: f32, edge_count: f32, edge_parts: f32, radius: f32) -> vec3f {
  let first = i32(first_edge);
  let count = i32(edge_count);
  let parts = i32(edge_parts);
  let reach = lamps[lamp].position - facet.position;
  let middle = lamp_middle(facet, reach, radius);
  var held = Held(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
  for (var i = 0; i < count * parts; i++) {
    let edge = edges[first + i / parts];
    let left = dot(edge.left_plane, vec4f(facet.position, 1.0)) > 0.0;
    let right = dot(edge.right_plane, vec4f(facet.position, 1.0)) > 0.0;
    let light = select(vec3f(0.0), edge.right_light, right) - select(vec3f(0.0), edge.left_light, left);
    let start = edge.start - facet.position;
    let way = (edge.end - edge.start) / f32(parts);
    let part = f32(i % parts);
    held = with_edge(held, facet, middle, start + part * way, start + (part + 1.0) * way, light);
  }
  return held_light(held, facet, reach, radius);
}
