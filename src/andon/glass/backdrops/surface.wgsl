// The scene's geometry with the frame on it: rays against the G-buffer; march.py has it. The shader
// that imports this declares `view` and `gbuffer`.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/glass/backdrops/trails.wgsl

const STEPS: f32 = 16.0;
const LOOKS: i32 = 40;
const NEAR_PX: f32 = 0.75;
const MAX_JUMP: f32 = 0.05;
// No depth, no plane.
const NONE: f32 = -1.0;

struct Look {
  pixel: vec2f,
  depth: f32,
  normal: vec3f,
  in_front: bool,
  plane: f32,
  own: bool,
};

fn looked_up(trail: Trail, s: f32, from_eye: vec3f, D: vec3f) -> Look {
  let p = trail_point(trail, s);
  let pixel = pixel_of(p);
  let reached = depth_of(p) / max(1.0 - s * trail.fade, TINY);
  let size = vec2i(view.size);
  var nearest = vec2i(floor(pixel));
  if (WIDTH_REPEATS) { nearest.x = (nearest.x + size.x) % size.x; }
  let inside = all(abs(pixel - 0.5 * view.size) <= 0.5 * view.size + 1e-3);
  nearest = clamp(nearest, vec2i(0), size - 1);
  let packed = textureLoad(gbuffer, nearest, 0);
  let valid = inside && (packed.w & VALID) != 0u;
  let depth = select(NONE, bitcast<f32>(packed.x), valid);
  let N = octahedral_decode(packed.y);
  let facing = dot(N, D);
  let height = dot(N, world_ray(vec2f(nearest) + 0.5) * depth - from_eye);
  let ahead = valid && facing < 0.0 && height < 0.0;
  let plane = select(NONE, height / min(facing, -TINY), ahead);
  let met = pixel_of(trail_point(trail, trail_s(trail, max(plane, 0.0))));
  let own = ahead && apart(pixel, met) <= NEAR_PX;
  return Look(pixel, depth, N, !(valid && depth <= reached), plane, own);
}

struct Met {
  distance: f32,
  normal: vec3f,
};

// The first hit; distance NONE where there is none.
fn march(trail: Trail, from_eye: vec3f, D: vec3f) -> Met {
  let start = pixel_of(trail_point(trail, trail.first));
  var length_px = STEPS;
  if (IS_PLANAR) {
    length_px = clamp(apart(start, pixel_of(trail_point(trail, trail.last))), 1.0, STEPS);
  }
  let step = (trail.last - trail.first) / length_px;
  var s = trail.first;
  var low = s;
  var high = s;
  var low_px = start;
  var high_px = start;
  var low_depth = NONE;
  var high_depth = NONE;
  var high_plane = NONE;
  var high_normal = vec3f(0.0);
  var front = false;
  var closed = false;
  for (var number = 0; number < LOOKS; number++) {
    if (trail.last < trail.first) { break; }
    let look = looked_up(trail, s, from_eye, D);
    if (look.own) { return Met(look.plane, look.normal); }
    let opens = !closed && front && !look.in_front;
    if (opens || (closed && !look.in_front)) {
      high = s;
      high_px = look.pixel;
      high_depth = look.depth;
      high_plane = look.plane;
      high_normal = look.normal;
    } else {
      low = s;
      low_px = look.pixel;
      low_depth = select(low_depth, look.depth, look.depth > 0.0);
    }
    if (!closed && !opens) { front = look.in_front; }
    closed = closed || opens;
    if (closed && apart(low_px, high_px) < 1.0) {
      let nearer = min(low_depth, high_depth);
      if (nearer > 0.0 && abs(low_depth - high_depth) <= MAX_JUMP * nearer) {
        let a = trail_distance(trail, low);
        let b = trail_distance(trail, high);
        return Met(clamp(select(0.5 * (a + b), high_plane, high_plane > 0.0), a, b), high_normal);
      }
      closed = false;
      front = false;
      low = high;
      low_px = high_px;
    }
    if (!closed && low >= trail.last) { break; }
    let cut = trail_s(trail, max(look.plane, 0.0));
    // Every third time in the middle: cuts with one side alone may creep.
    let within = look.plane > 0.0 && cut > low && cut < high && number % 3 != 2;
    let inside = select(0.5 * (low + high), cut, within);
    s = select(min(low + step, trail.last), inside, closed);
  }
  return Met(NONE, vec3f(0.0));
}

fn surface_seen(solid: i32, origin: vec3f, direction: vec3f, footprint: Footprint) -> Seen {
  let from_eye = origin - view.position;
  let hit = march(make_trail(from_eye, direction), from_eye, direction);
  if (hit.distance <= 0.0) { return frame_light(direction, footprint.course, FAR, true); }
  let moved = footprint_at(footprint, direction, hit.normal, hit.distance);
  return frame_light(from_eye + hit.distance * direction, moved, hit.distance, false);
}
