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

// Light of one side of an edge, if the receiver is in front of it.
fn side_light(plane: vec4f, light: vec3f, position: vec3f) -> vec3f {
  return select(vec3f(0.0), light, dot(plane.xyz, position) + plane.w > 0.0);
}

// `count` edges from `first` on.
fn edges_illuminance(lamp: i32, first: i32, count: i32, position: vec3f, normal: vec3f) -> vec3f {
  let towards = lamps[lamp].position - position;
  var total = vec3f(0.0);
  for (var i = 0; i < count; i++) {
    let edge = edges[first + i];
    let light = side_light(edge.left_plane, edge.left_light, position)
              - side_light(edge.right_plane, edge.right_light, position);
    total += light * edge_factor(edge.start - position, edge.end - position, normal, towards);
  }
  return max(total, vec3f(0.0));
}
