// Rays in the world and in the frames of solids. The shader that imports this declares `solids`.

//!struct SolidRecord
//!import andon/glass/hit.wgsl

struct Ray {
  origin: vec3f,
  // Unit.
  direction: vec3f,
};

// The nearest boundary of all solids, in world axes; solid −1 for none.
struct Boundary {
  distance: f32,
  normal: vec3f,
  facet: vec3f,
  curvature: Curvature,
  triangle: i32,
  solid: i32,
  // All solids whose boundary this is: touching ones are crossed together, no air between them.
  crossed: u32,
};

fn no_boundary() -> Boundary {
  return Boundary(NOWHERE, vec3f(0.0), vec3f(0.0), FLAT, -1, -1, 0u);
}

fn world_from_glass(solid: i32) -> mat3x3f {
  return mat3x3f(solids[solid].right, solids[solid].up, solids[solid].front);
}

fn local_point(point: vec3f, solid: i32) -> vec3f {
  return (point - solids[solid].centre) * world_from_glass(solid);
}

fn local_ray(ray: Ray, solid: i32) -> Ray {
  return Ray(local_point(ray.origin, solid), ray.direction * world_from_glass(solid));
}

// `near`: boundaries that close to each other are one.
fn nearer(nearest: Boundary, hit: Hit, solid: i32, near: f32) -> Boundary {
  let own = 1u << u32(solid);
  if hit.distance >= nearest.distance {
    var both = nearest;
    both.crossed |= select(0u, own, hit.distance <= nearest.distance + near && hit.distance < NOWHERE);
    return both;
  }
  let turn = world_from_glass(solid);
  return Boundary(
    hit.distance, turn * hit.normal, turn * hit.facet, turned(turn, hit.curvature), hit.triangle, solid,
    own | select(0u, nearest.crossed, nearest.distance <= hit.distance + near),
  );
}
