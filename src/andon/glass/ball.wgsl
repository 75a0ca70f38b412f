// Where a ray meets a sphere around the origin. Rays that are inside ask for where they leave,
// others for where they enter: so none meets the boundary that it stands on.

//!import andon/glass/hit.wgsl
//!import andon/gpu/pi.wgsl

fn ball_hit(origin: vec3f, direction: vec3f, radius: f32, inside: bool) -> Hit {
  let along = -dot(origin, direction);
  // From the foot of the perpendicular: the difference of squares of far eyes has no digits.
  let foot = origin + along * direction;
  let square = radius * radius - dot(foot, foot);
  let half = sqrt(max(square, 0.0));
  let distance = along + select(-half, half, inside);
  let met = inside || (square > 0.0 && distance > 0.0);
  let normal = (origin + distance * direction) / radius;
  return Hit(select(NOWHERE, distance, met), normal, normal, spherical(1.0 / radius), -1);
}

// Longitude and latitude: the middle of the picture is at +z, row 0 at +y.
fn ball_sticking(point: vec3f, radius: f32, moves: mat2x3f) -> Sticking {
  let height = clamp(point.y / radius, -1.0, 1.0);
  let uv = vec2f(0.5 + atan2(point.x, point.z) / (2.0 * PI), acos(height) / PI);
  // Next to a pole a step turns by all longitudes.
  let square = max(dot(point.xz, point.xz), 1e-6 * radius * radius);
  let u = vec3f(point.z, 0.0, -point.x) / (2.0 * PI * square);
  let v = vec3f(0.0, -1.0 / (PI * sqrt(square)), 0.0);
  return Sticking(uv, transpose(mat2x2f(u * moves, v * moves)));
}
