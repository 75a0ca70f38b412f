// The scene's geometry with the frame on it: rays against the G-buffer; march.py has it. The shader
// that imports this declares `view` and `gbuffer`.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/glass/backdrops/trails.wgsl

const STEPS: i32 = 128;
const LOOKS: i32 = 12;
const ROUNDS: i32 = 8;
const NEAR_PX: f32 = 0.75;
const MAX_JUMP: f32 = 0.05;
// No depth, no plane.
const NONE: f32 = -1.0;

// Where a ray is in the picture, the pixel's texel, and its depth; NONE for holes and beside it.
struct Spot {
  place: vec2f,
  pixel: vec2i,
  packed: vec4u,
  depth: f32,
  in_front: bool,
};

fn spot_at(trail: Trail, s: f32) -> Spot {
  let p = trail_point(trail, s);
  let place = pixel_of(p);
  let size = vec2i(view.size);
  var pixel = vec2i(floor(place));
  if (WIDTH_REPEATS) { pixel.x = (pixel.x + size.x) % size.x; }
  let inside = all(abs(place - 0.5 * view.size) <= 0.5 * view.size + 1e-3);
  pixel = clamp(pixel, vec2i(0), size - 1);
  let packed = textureLoad(gbuffer, pixel, 0);
  let valid = inside && (packed.w & VALID) != 0u;
  let depth = select(NONE, bitcast<f32>(packed.x), valid);
  // depth > reached, which is depth_of(p)/w.
  let in_front = !valid || depth * max(1.0 - s * trail.fade, TINY) > depth_of(p);
  return Spot(place, pixel, packed, depth, in_front);
}

// Where nothing was hit but something hides the ray, `distance` is to where it went out of sight.
struct Met {
  distance: f32,
  normal: vec3f,
  hidden: bool,
};

// Where the ray meets the pixel's plane from its front, else NONE.
fn plane_of(spot: Spot, from_eye: vec3f, D: vec3f) -> Met {
  let N = octahedral_decode(spot.packed.y);
  let facing = dot(N, D);
  let height = dot(N, world_ray(vec2f(spot.pixel) + 0.5) * spot.depth - from_eye);
  let met = spot.depth > 0.0 && facing < 0.0 && height < 0.0;
  return Met(select(NONE, height / min(facing, -1e-20), met), N, false);
}

struct Interval {
  low: f32,
  high: f32,
  // Of what was last in front of the ray.
  depth: f32,
};

// The hit between low and high; at an edge hidden, and where that is.
fn narrowed(trail: Trail, whole: Interval, step: f32, from_eye: vec3f, D: vec3f) -> Met {
  var now = whole;
  var low_at = pixel_of(trail_point(trail, now.low));
  var high_at = pixel_of(trail_point(trail, now.high));
  var s = now.high;
  for (var number = 0; number < LOOKS; number++) {
    let spot = spot_at(trail, s);
    let plane = plane_of(spot, from_eye, D);
    let cut = trail_s(trail, max(plane.distance, 0.0));
    if (plane.distance > 0.0 && apart(spot.place, pixel_of(trail_point(trail, cut))) <= NEAR_PX) {
      return plane;
    }
    let nearer = min(now.depth, spot.depth);
    let joined = nearer > 0.0 && abs(now.depth - spot.depth) <= MAX_JUMP * nearer;
    let moves = s > now.low && s <= now.high;
    if (moves && spot.in_front) {
      now = Interval(s, now.high, select(now.depth, spot.depth, spot.depth > 0.0));
      low_at = spot.place;
    } else if (moves) {
      now.high = s;
      high_at = spot.place;
    }
    let width = now.high - now.low;
    let narrow = apart(low_at, high_at) < 1.0;
    if (narrow && !spot.in_front) {
      let a = trail_distance(trail, now.low - width);
      let b = trail_distance(trail, now.high + width);
      let middle = trail_distance(trail, now.low + 0.5 * width);
      let between = select(middle, clamp(plane.distance, max(a, 0.0), b), plane.distance > 0.0);
      if (joined) { return Met(between, plane.normal, false); }
      break;
    }
    // Where a ray grazes, depths of whole pixels cross it beside its true place: the first cut may
    // lie outside. Every third time in the middle: cuts with one side alone may creep.
    let beyond = select(0.0, step, number == 0);
    let within = plane.distance > 0.0 && cut > now.low - beyond && cut < now.high + beyond
      && number % 3 != 2;
    s = select(select(now.low + 0.5 * width, cut, within), now.high, narrow);
  }
  // Where nothing was in front before, the ray began out of sight.
  return Met(select(NONE, trail_distance(trail, now.low), now.depth > 0.0), -D, true);
}

// The first hit; distance NONE where there is none.
fn march(trail: Trail, from_eye: vec3f, D: vec3f) -> Met {
  var steps = f32(STEPS);
  if (IS_PLANAR) {
    let start = pixel_of(trail_point(trail, trail.first));
    steps = clamp(apart(start, pixel_of(trail_point(trail, trail.last))), 1.0, f32(STEPS));
  }
  let step = (trail.last - trail.first) / steps;
  let start = spot_at(trail, trail.first);
  var now = Interval(trail.first, trail.first, start.depth);
  var front = start.in_front;
  var edge = Met(NONE, vec3f(0.0), false);
  for (var round = 0; round < ROUNDS; round++) {
    var behind = false;
    for (var k = 0; k <= STEPS; k++) {
      if (behind || !(now.low < trail.last)) { break; }
      let s = min(now.low + step, trail.last);
      let spot = spot_at(trail, s);
      behind = front && !spot.in_front;
      if (behind) {
        now.high = s;
      } else {
        // Over a hole as before.
        front = select(front, spot.in_front, spot.depth > 0.0);
        now = Interval(s, s, select(now.depth, spot.depth, spot.depth > 0.0));
      }
    }
    if (!behind) { break; }
    let met = narrowed(trail, now, step, from_eye, D);
    if (!met.hidden) { return met; }
    if (met.distance > 0.0) { edge = met; }
    now.low = now.high;
    front = false;
  }
  return Met(select(edge.distance, NONE, front), edge.normal, edge.hidden);
}

fn surface_seen(solid: i32, origin: vec3f, direction: vec3f, footprint: Footprint) -> Seen {
  let from_eye = origin - view.position;
  let hit = march(make_trail(from_eye, direction), from_eye, direction);
  if (hit.distance <= 0.0) { return frame_light(direction, footprint.course, FAR, true); }
  let moved = footprint_at(footprint, direction, hit.normal, hit.distance);
  return frame_light(from_eye + hit.distance * direction, moved, hit.distance, hit.hidden);
}
