// Six plane faces into two paraboloids: the radial distance, in each texel, of the plane of the
// triangle that is seen there.

//!import andon/transport/direct/shadows/paraboloid.wgsl

@group(0) @binding(0) var faces: texture_2d<f32>;

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

fn radial_distance(direction: vec3f, face_size: f32) -> f32 {
  let a = abs(direction);
  var face = 0;
  var q = direction.yzx;
  var along = a.x;
  if (a.y > a.x && a.y >= a.z) { face = 2; q = direction.zxy; along = a.y; }
  else if (a.z > a.x && a.z > a.y) { face = 4; q = direction; along = a.z; }
  face += select(0, 1, q.z < 0.0);
  let place = (q.xy / along * 0.5 + 0.5) * face_size - 0.5;
  let corner = vec2i(i32(face_size)) * vec2i(face % 3, face / 3);
  let low = clamp(vec2i(floor(place)), vec2i(0), vec2i(i32(face_size) - 2));
  let near = clamp(vec2i(round(place)), low, low + 1);
  let here = plane_distance(corner + near, direction);
  // Between two planes of a convex edge the farther one is the surface: the nearer is its own
  // continuation past the edge, and would shadow the surface beside it. Across a silhouette the
  // texel's own triangle holds.
  let across = vec2i(2 * low.x + 1 - near.x, near.y);
  let down = vec2i(near.x, 2 * low.y + 1 - near.y);
  let limit = here * SAME_SURFACE;
  return max(
    neighbour(corner + across, direction, here, limit),
    max(
      neighbour(corner + down, direction, here, limit),
      neighbour(corner + vec2i(across.x, down.y), direction, here, limit),
    ),
  );
}

struct Discs {
  @location(0) front: f32,
  @location(1) back: f32,
};

@fragment fn both_discs(@builtin(position) pixel: vec4f) -> Discs {
  let face_size = f32(textureDimensions(faces).x / 3u);
  // A map has twice the texels of a face along a side, so that both have equal solid angles.
  let u = pixel.xy / face_size - 1.0;
  let direction = paraboloid_direction(u, 1.0) / (1.0 + dot(u, u));
  return Discs(
    radial_distance(direction, face_size),
    radial_distance(direction * vec3f(1.0, 1.0, -1.0), face_size),
  );
}
