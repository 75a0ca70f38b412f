// What is mirrored of flat and long lamps, and of lamps with corners: outlines.py.

//!import andon/glare/highlights/outlines.wgsl

// Half a circle of a tube in four parts: π/(4·sin 45°).
const HALF_SAME_AREA: f32 = 1.1107207;

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
  let wide = way * radius / sqrt(1.0 - sine * sine);
  return end + wide * (HALF_SAME_AREA * cos(turn) * along + sin(turn) * cross(sight, along));
}

fn tube_highlight(facet: Facet, lamp: i32) -> vec3f {
  let record = lamps[lamp];
  let ends = array<vec3f, 2>(record.right - facet.position, record.position - facet.position);
  let axis = record.right - record.position;
  var corners: array<vec3f, 16>;
  for (var i = 0; i < 5; i++) {
    let turn = -0.5 * PI + f32(i) * (0.25 * PI);
    corners[i] = tube_corner(ends[0], axis, record.radius_m, 1.0, turn);
    corners[8 + i] = tube_corner(ends[1], axis, record.radius_m, -1.0, turn);
  }
  for (var i = 1; i < 4; i++) {
    corners[4 + i] = mix(corners[4], corners[8], f32(i) * 0.25);
    corners[12 + i] = mix(corners[12], corners[0], f32(i) * 0.25);
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
