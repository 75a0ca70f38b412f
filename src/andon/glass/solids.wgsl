// The solids of a scene; plan.py writes this for each scene. This is one ball with two interfaces.

//!import andon/glass/rays.wgsl
//!import andon/glass/ball.wgsl

const SOLIDS: i32 = 1;
// Boundaries on one path, at most.
const EVENTS: i32 = 2;
// One body that a ray leaves for good.
const CONVEX_ALONE: bool = true;
// Nothing is seen but through first boundaries.
const ENTRY_ONLY: bool = false;
// Total reflection can happen.
const MIRRORS: bool = false;
// Channels have different indices.
const DISPERSES: bool = false;
// Something sticks to one of them.
const STICKERS: bool = true;

// Normals are interpolated: a triangle's own holds where they would send light to its wrong side.
const FACETS: bool = false;
// Metres between boundaries that are one.
const NEAR: f32 = 3e-7;

fn boundary(ray: Ray, inside: u32) -> Boundary {
  var nearest = no_boundary();
  {
    let local = local_ray(ray, 0);
    let hit = ball_hit(local.origin, local.direction, solids[0].size.x, (inside & 1u) != 0u);
    nearest = nearer(nearest, hit, 0, NEAR);
  }
  return nearest;
}

// `moves`: columns are what the point moves by for a step of one pixel.
fn sticking(met: Boundary, point: vec3f, moves: mat2x3f) -> Sticking {
  let turn = world_from_glass(0);
  let steps = mat2x3f(moves[0] * turn, moves[1] * turn);
  return ball_sticking(local_point(point, 0), solids[0].size.x, steps);
}
