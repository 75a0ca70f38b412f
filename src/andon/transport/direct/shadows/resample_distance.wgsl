// What a disc holds: metres to the plane of the triangle that is seen.

// Metres; what stands for "nothing there".
const FAR: f32 = 1e30;
// Beyond a million metres, or a triangle that is seen edge-on: no distance.
const EDGE_ON: f32 = 1e-6;

// Planes within this ratio of each other, half a texel from where they are seen, are neighbours.
const SAME_SURFACE: f32 = 1.05;

fn plane_distance(texel: vec2i, direction: vec3f) -> f32 {
  let inverse = dot(textureLoad(faces, texel, 0).xyz, direction);
  return select(FAR, 1.0 / inverse, inverse > EDGE_ON);
}

fn neighbour(texel: vec2i, direction: vec3f, here: f32, limit: f32) -> f32 {
  let distance = plane_distance(texel, direction);
  return select(here, max(here, distance), distance < limit);
}

// Between two planes of a convex edge the farther one is the surface: the nearer is its own
// continuation past the edge, and would shadow the surface beside it. Across a silhouette the
// texel's own triangle holds.
fn choose(direction: vec3f, near: vec2i, across: vec2i, down: vec2i, opposite: vec2i) -> f32 {
  let here = plane_distance(near, direction);
  let limit = here * SAME_SURFACE;
  return max(
    neighbour(across, direction, here, limit),
    max(neighbour(down, direction, here, limit), neighbour(opposite, direction, here, limit)),
  );
}
