// Where a point of the camera's frame is seen (GPU convention: centres at +0.5), and how far its
// pixel moves when the point does. Columns begin again at the border where WIDTH_REPEATS.

const WIDTH_REPEATS: bool = false;
// The view measures depth along its axis, and its rays can be clipped by the picture's border.
const IS_PLANAR: bool = true;

fn pixel_of(p: vec3f) -> vec2f {
  return p.xy / p.z * view.focal + view.centre;
}

fn is_seen(p: vec3f) -> bool {
  return p.z > 0.0;
}

fn depth_of(p: vec3f) -> f32 {
  return p.z;
}

fn moved_pixel(p: vec3f, shift: vec3f) -> vec2f {
  return (shift.xy - p.xy / p.z * shift.z) / p.z * view.focal;
}
