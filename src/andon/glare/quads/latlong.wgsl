// The rectangle of a latlong picture that holds a cap; it may reach over the seam, to columns below 0
// or beyond the last, and is then drawn a second time, a picture's width away. The shader that
// imports this declares `view`.

//!import andon/gpu/pi.wgsl

// Left, top, right, bottom in pixels of what lies within `radius` of `direction` (unit, camera
// frame). Meridians touch a cap at the azimuth asin(sin r/cos el); with a pole inside it has all.
fn cap_box(direction: vec3f, radius: f32) -> vec4f {
  let elevation = atan2(-direction.y, length(direction.xz));
  let azimuth = atan2(direction.x, direction.z);
  let columns = view.size.x / (2.0 * PI);
  let rows = view.size.y / PI;
  let top = (0.5 * PI - elevation - radius) * rows;
  let bottom = (0.5 * PI - elevation + radius) * rows;
  if (abs(elevation) + radius >= 0.5 * PI) {
    return vec4f(0.0, top, view.size.x, bottom);
  }
  let half_width = asin(min(1.0, sin(radius) / cos(elevation))) * columns;
  let middle = (azimuth + PI) * columns;
  return vec4f(middle - half_width, top, middle + half_width, bottom);
}
