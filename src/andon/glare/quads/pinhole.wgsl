// The rectangle of a pinhole picture that holds a cap. The shader that imports this declares `view`.

//!import andon/gpu/pi.wgsl

// Left, top, right, bottom in pixels of what lies within `radius` of `direction` (unit, camera
// frame): the outline of a ball of radius sin r at distance 1. A cap that reaches through the plane
// of the eye is the whole picture, one behind it nothing.
fn cap_box(direction: vec3f, radius: f32) -> vec4f {
  let sine = sin(min(radius, 0.5 * PI));
  let z = direction.z;
  if (z <= sine) {
    return vec4f(0.0, 0.0, select(vec2f(0.0), view.size, z > -sine || radius > 0.5 * PI));
  }
  let planar = direction.xy;
  let reach = sine * sqrt(planar * planar + z * z - sine * sine);
  let low = (planar * z - reach) / (z * z - sine * sine);
  let high = (planar * z + reach) / (z * z - sine * sine);
  return vec4f(view.focal * low + view.centre, view.focal * high + view.centre);
}
