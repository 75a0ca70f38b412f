// Where a ray meets a box around the origin: entry from outside, exit from inside.

//!import andon/glass/hit.wgsl

fn slab_hit(origin: vec3f, direction: vec3f, half: vec3f, inside: bool) -> Hit {
  // A component that is 0 would give 0·∞ on the face itself: a hair beside it gives ±∞.
  let safe = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
  let sides = sign(safe);
  let entry = (-sides * half - origin) / safe;
  let leave = (sides * half - origin) / safe;
  let first = max(entry.x, max(entry.y, entry.z));
  let last = min(leave.x, min(leave.y, leave.z));
  let distance = select(first, max(last, 0.0), inside);
  let face = select(entry == vec3f(first), leave == vec3f(last), vec3<bool>(inside));
  // On an edge two faces are as near: the first of them.
  let one = vec3<bool>(face.x, face.y && !face.x, face.z && !face.x && !face.y);
  let normal = select(vec3f(0.0), select(-sides, sides, inside), one);
  let met = inside || (first < last && first > 0.0);
  return Hit(select(NOWHERE, distance, met), normal, normal, FLAT, -1);
}

// On the two faces across z.
fn slab_sticking(point: vec3f, normal: vec3f, half: vec3f, moves: mat2x3f) -> Sticking {
  if abs(normal.z) < 0.5 {
    return nothing_sticks();
  }
  let scale = vec2f(0.5, -0.5) / half.xy;
  let uv = clamp(0.5 + scale * point.xy, vec2f(0.0), vec2f(1.0));
  return Sticking(uv, mat2x2f(scale * moves[0].xy, scale * moves[1].xy));
}
