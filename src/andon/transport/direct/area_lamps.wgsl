// Area lamps, unshadowed: luminance × form factor.

//!import andon/transport/direct/areas.wgsl
//!struct EdgeRecord

@group(1) @binding(7) var<storage, read> edges: array<EdgeRecord>;

fn sphere_illuminance(lamp: i32, position: vec3f, normal: vec3f) -> vec3f {
  let record = lamps[lamp];
  return record.light * sphere_factor(record.position - position, normal, record.radius_m);
}

fn disk_illuminance(lamp: i32, position: vec3f, normal: vec3f) -> vec3f {
  let record = lamps[lamp];
  return record.light * disk_factor(record.position - position, normal, record.axis, record.radius_m);
}

// A receiver is on one side only: the disk shows it that one.
fn disk_both_sides_illuminance(lamp: i32, position: vec3f, normal: vec3f) -> vec3f {
  let record = lamps[lamp];
  let reach = record.position - position;
  let axis = select(record.axis, -record.axis, dot(record.axis, reach) > 0.0);
  return record.light * disk_factor(reach, normal, axis, record.radius_m);
}

fn tube_illuminance(lamp: i32, position: vec3f, normal: vec3f) -> vec3f {
  let record = lamps[lamp];
  return record.light
    * tube_factor(record.position - position, record.right - position, normal, record.radius_m);
}

// Flat lamps: `count` edges of the outline from `first` on.
fn outline_factor(lamp: i32, first: i32, count: i32, position: vec3f, normal: vec3f) -> f32 {
  let record = lamps[lamp];
  let towards = polygon_towards(record.position - position, record.radius_m, record.axis, normal);
  var total = 0.0;
  for (var i = 0; i < count; i++) {
    total += edge_factor(edges[first + i].start - position, edges[first + i].end - position, normal, towards);
  }
  return total;
}

fn polygon_illuminance(lamp: i32, first: i32, count: i32, position: vec3f, normal: vec3f) -> vec3f {
  return lamps[lamp].light * max(outline_factor(lamp, first, count, position, normal), 0.0);
}

fn polygon_both_sides_illuminance(lamp: i32, first: i32, count: i32, position: vec3f, normal: vec3f) -> vec3f {
  return lamps[lamp].light * abs(outline_factor(lamp, first, count, position, normal));
}

// The receiver's height above the plane of a facet in w.
fn seen_from(plane: vec4f, position: vec3f) -> vec4f {
  return vec4f(plane.xyz, dot(plane.xyz, position) + plane.w);
}

// Meshes and luminous pictures: `count` edges from `first` on, each has the facet on its left and the one on its right.
fn edges_illuminance(lamp: i32, first: i32, count: i32, position: vec3f, normal: vec3f) -> vec3f {
  let towards = mesh_towards(lamps[lamp].position - position, normal);
  var total = vec3f(0.0);
  for (var i = 0; i < count; i++) {
    let edge = edges[first + i];
    let left = seen_from(edge.left_plane, position);
    let right = seen_from(edge.right_plane, position);
    let share = facet_edge_factor(
      edge.start - position, edge.end - position, left, right, normal, towards,
    );
    total += edge.left_light * share.x - edge.right_light * share.y;
  }
  // Light that is taken away is negative; rounding must not turn either round.
  let side = sign(lamps[lamp].light);
  return side * max(side * total, vec3f(0.0));
}
