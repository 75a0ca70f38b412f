// The whole sphere, forward in the middle. See pinhole.wgsl.

//!import andon/gpu/pi.wgsl

const WIDTH_REPEATS: bool = true;
const IS_PLANAR: bool = false;

fn pixel_of(p: vec3f) -> vec2f {
  let azimuth = atan2(p.x, p.z);
  let fallen = atan2(p.y, length(p.xz));
  return (vec2f(azimuth / (2.0 * PI), fallen / PI) + 0.5) * view.size;
}

fn is_seen(p: vec3f) -> bool {
  return true;
}

fn depth_of(p: vec3f) -> f32 {
  return length(p);
}

fn moved_pixel(p: vec3f, shift: vec3f) -> vec2f {
  let level = max(dot(p.xz, p.xz), 1e-20);
  let azimuth = (p.z * shift.x - p.x * shift.z) / level;
  let fallen = (shift.y * level - p.y * dot(p.xz, shift.xz)) / (sqrt(level) * (level + p.y * p.y));
  return vec2f(azimuth / (2.0 * PI), fallen / PI) * view.size;
}
