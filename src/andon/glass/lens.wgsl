// Where a ray meets two spherical caps on the z axis, cut by a cylinder.
//
// Rays inside ask for boundaries that they cross outwards, others for those they cross inwards: of
// the two points where a ray meets a sphere that leaves one, and none stands in its own way.

//!import andon/glass/hit.wgsl

// A cap of the signed radius `bend` around (0, 0, middle), of the half that bulges to where
// (z − middle)·side·bend > 0; side is +1 in front, −1 at the back.
fn cap_distance(origin: vec3f, direction: vec3f, middle: f32, bend: f32, side: f32, rim: f32, inside: bool) -> f32 {
  let to = origin - vec3f(0.0, 0.0, middle);
  let along = -dot(to, direction);
  let foot = to + along * direction;
  let square = bend * bend - dot(foot, foot);
  let half = sqrt(max(square, 0.0));
  let distance = along + select(-half, half, inside == (bend > 0.0));
  let at = to + distance * direction;
  let met = square > 0.0 && distance > 0.0 && at.z * side * bend > 0.0 && dot(at.xy, at.xy) <= rim * rim;
  return select(NOWHERE, distance, met);
}

// The edge: a cylinder from z = low to z = high.
fn rim_distance(origin: vec3f, direction: vec3f, rim: f32, low: f32, high: f32, inside: bool) -> f32 {
  let speed = dot(direction.xy, direction.xy);
  let along = -dot(origin.xy, direction.xy) / max(speed, 1e-20);
  let foot = origin.xy + along * direction.xy;
  let square = rim * rim - dot(foot, foot);
  let half = sqrt(max(square, 0.0) / max(speed, 1e-20));
  let distance = along + select(-half, half, inside);
  let z = origin.z + distance * direction.z;
  return select(NOWHERE, distance, square > 0.0 && distance > 0.0 && z > low && z < high);
}

// z of a cap of the signed radius `bend` around (0, 0, middle), at its rim.
fn rim_height(middle: f32, bend: f32, side: f32, rim: f32) -> f32 {
  return middle + side * sign(bend) * sqrt(max(bend * bend - rim * rim, 0.0));
}

// shape: rim radius, curvature radii in front and at the back, thickness on the axis.
fn lens_hit(origin: vec3f, direction: vec3f, shape: vec4f, inside: bool) -> Hit {
  let front = 0.5 * shape.w - shape.y;
  let back = shape.z - 0.5 * shape.w;
  let to_front = cap_distance(origin, direction, front, shape.y, 1.0, shape.x, inside);
  let to_back = cap_distance(origin, direction, back, shape.z, -1.0, shape.x, inside);
  let low = rim_height(back, shape.z, -1.0, shape.x);
  let high = rim_height(front, shape.y, 1.0, shape.x);
  let to_rim = rim_distance(origin, direction, shape.x, low, high, inside);
  let distance = min(to_front, min(to_back, to_rim));
  let point = origin + distance * direction;
  if to_rim <= distance {
    let normal = vec3f(point.xy / shape.x, 0.0);
    let turning = cylindrical(1.0 / shape.x, vec3f(0.0, 0.0, 1.0));
    return Hit(distance, normal, normal, turning, -1);
  }
  let is_front = to_front <= distance;
  let bend = select(shape.z, shape.y, is_front);
  let normal = (point - vec3f(0.0, 0.0, select(back, front, is_front))) / bend;
  return Hit(distance, normal, normal, spherical(1.0 / bend), -1);
}

// On both caps.
fn lens_sticking(point: vec3f, normal: vec3f, shape: vec4f, moves: mat2x3f) -> Sticking {
  // The rim's normals are across z, but for rounding.
  if abs(normal.z) < 1e-5 {
    return nothing_sticks();
  }
  let scale = vec2f(0.5, -0.5) / shape.x;
  let uv = 0.5 + scale * point.xy;
  return Sticking(uv, mat2x2f(scale * moves[0].xy, scale * moves[1].xy));
}
