// A ray as the curve that it draws in the picture; trails.py has it.

//!import andon/glass/backdrops/frame_light.wgsl

const ALONG: f32 = 1e-5;
const NEAREST_M: f32 = 0.01;
const TINY: f32 = 1e-12;

// P(s) = w·origin + s·tau·direction, w = 1 − s·fade, in the camera's frame; P/w is on the ray.
struct Trail {
  origin: vec3f,
  direction: vec3f,
  tau: f32,
  fade: f32,
  first: f32,
  last: f32,
};

fn trail_point(trail: Trail, s: f32) -> vec3f {
  return (1.0 - s * trail.fade) * trail.origin + s * trail.tau * trail.direction;
}

fn trail_s(trail: Trail, distance: f32) -> f32 {
  return distance / max(trail.tau + distance * trail.fade, TINY);
}

fn trail_distance(trail: Trail, s: f32) -> f32 {
  return s * trail.tau / max(1.0 - s * trail.fade, TINY);
}

// What of a pinhole's trail, a straight line, is in the picture.
fn clipped_trail(whole: Trail) -> Trail {
  var trail = whole;
  let start = pixel_of(trail_point(trail, 0.0));
  let run = pixel_of(trail_point(trail, 1.0)) - start;
  let safe = select(run, vec2f(TINY), abs(run) < vec2f(TINY));
  let a = -start / safe;
  let b = (view.size - start) / safe;
  let enter = min(a, b);
  let leave = max(a, b);
  trail.first = max(max(enter.x, enter.y), 0.0);
  trail.last = min(min(leave.x, leave.y), 1.0);
  if (!(trail.origin.z > NEAREST_M && trail.last >= trail.first)) { trail.last = -1.0; }
  return trail;
}

fn make_trail(from_eye: vec3f, course: vec3f) -> Trail {
  let origin = camera_direction(from_eye);
  var direction = camera_direction(course);
  if (!IS_PLANAR) { return Trail(origin, direction, length(origin), 1.0, 0.0, 1.0); }
  if (abs(direction.z) < ALONG) { direction.z = ALONG; }
  let grown = origin.z / NEAREST_M;
  let away = direction.z > 0.0;
  let tau = select(grown * (NEAREST_M - origin.z), origin.z, away) / direction.z;
  return clipped_trail(Trail(origin, direction, tau, select(1.0 - grown, 1.0, away), 0.0, 1.0));
}

// Pixels from a to b; the shorter way around a latlong picture.
fn apart(a: vec2f, b: vec2f) -> f32 {
  var run = b - a;
  if (WIDTH_REPEATS) { run.x -= view.size.x * round(run.x / view.size.x); }
  return length(run);
}
