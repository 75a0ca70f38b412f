// Six plane faces into two paraboloids: in each texel the radial distance of what is seen there,
// or, for exact shadows, which triangle it is.

//!import andon/transport/direct/shadows/paraboloid.wgsl

@group(0) @binding(0) var faces: texture_2d<f32>;

//!import andon/transport/direct/shadows/resample_distance.wgsl

fn disc_value(direction: vec3f, face_size: f32) -> f32 {
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
  // The nearest texel, and the three others around the direction.
  let other = 2 * low + 1 - near;
  return choose(
    direction, corner + near, corner + vec2i(other.x, near.y), corner + vec2i(near.x, other.y), corner + other,
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
    disc_value(direction, face_size),
    disc_value(direction * vec3f(1.0, 1.0, -1.0), face_size),
  );
}
