// Frames about a direction: `frames` of outlines.py.

// Both are right-handed with the unit `axis`. Source: Duff et al. 2017, without branches.
fn first_of_frame(axis: vec3f) -> vec3f {
  let side = select(-1.0, 1.0, axis.z >= 0.0);
  let s = -1.0 / (side + axis.z);
  return vec3f(1.0 + side * axis.x * axis.x * s, side * axis.x * axis.y * s, -side * axis.x);
}

fn second_of_frame(axis: vec3f) -> vec3f {
  let side = select(-1.0, 1.0, axis.z >= 0.0);
  let s = -1.0 / (side + axis.z);
  return vec3f(axis.x * axis.y * s, side + axis.y * axis.y * s, -axis.y);
}
