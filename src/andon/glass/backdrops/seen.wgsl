// What a ray finds behind the glass, and how it differs from those of the pixels beside it.

struct Seen {
  // Of the frame's white; 0 where missed.
  light: vec3f,
  // Metres along the ray; FAR where nothing was hit.
  distance: f32,
  // Nothing is there: the body's environment is seen.
  missed: bool,
  // The geometry is not in the frame, or hidden in it: light of the frame in the ray's direction.
  beside: bool,
};

// The last two columns of a pencil times a pixel's angle in radians: what origin and direction move
// by for a step of one pixel along e1 and e2.
struct Footprint {
  place: mat2x3f,
  course: mat2x3f,
};

const FAR: f32 = 1e6;

fn nothing_seen() -> Seen {
  return Seen(vec3f(0.0), FAR, true, false);
}

// Metres that the hit moves by on a surface with the normal N (Igehy 1999, equations 10 to 12).
fn footprint_at(footprint: Footprint, D: vec3f, N: vec3f, distance: f32) -> mat2x3f {
  let moved = footprint.place + footprint.course * distance;
  let along = (N * moved) / dot(D, N);
  return mat2x3f(moved[0] - along.x * D, moved[1] - along.y * D);
}
