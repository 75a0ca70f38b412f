// The rectangle of an equidistant picture that holds a cap. The shader that imports this declares
// `view`.

//!import andon/gpu/pi.wgsl

// Left, top, right, bottom in pixels of what lies within `radius` of `direction` (unit, camera
// frame). A picture stretches directions at θ from its axis by 1 outwards and θ/sin θ around, so no
// point of the cap is farther from its middle than the stretch at its far end times its radius.
fn cap_box(direction: vec3f, radius: f32) -> vec4f {
  let planar = length(direction.xy);
  let theta = atan2(planar, direction.z);
  let farthest = theta + radius;
  if (farthest > 0.95 * PI) {
    return vec4f(0.0, 0.0, view.size);
  }
  let middle = direction.xy * select(1.0, theta / planar, planar > 1e-6);
  let reach = radius * select(1.0, farthest / sin(farthest), farthest > 1e-4);
  return vec4f(view.focal * (middle - reach) + view.centre, view.focal * (middle + reach) + view.centre);
}
