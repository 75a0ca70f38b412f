// Six plane faces into two paraboloids: the radial distance of the triangle in each texel.

//!import andon/transport/direct/shadows/paraboloid.wgsl

//!struct FaceRecord

@group(0) @binding(0) var<uniform> lamp: FaceRecord;
@group(0) @binding(1) var face_depth: texture_depth_2d;
@group(0) @binding(2) var face_slope: texture_2d<f32>;

// Metres; what stands for "nothing there".
const FAR: f32 = 1e30;

fn radial_distance(direction: vec3f, face_size: f32) -> f32 {
  let a = abs(direction);
  var face = 0;
  var q = direction.yzx;
  var along = a.x;
  if (a.y > a.x && a.y >= a.z) { face = 2; q = direction.zxy; along = a.y; }
  else if (a.z > a.x && a.z > a.y) { face = 4; q = direction; along = a.z; }
  face += select(0, 1, q.z < 0.0);
  let place = (q.xy / along * 0.5 + 0.5) * face_size;
  let texel = min(floor(place), vec2f(face_size - 1.0));
  let at = vec2i(texel) + i32(face_size) * vec2i(face % 3, face / 3);
  let depth = textureLoad(face_depth, at, 0);
  if (depth <= 0.0) { return FAR; }
  // Clamped: the plane of a triangle seen edge-on runs away within half a texel.
  let change = dot(textureLoad(face_slope, at, 0).xy, place - texel - 0.5);
  return lamp.near_m / (depth * clamp(1.0 + change, 0.5, 2.0) * along);
}

struct Discs {
  @location(0) front: f32,
  @location(1) back: f32,
};

@fragment fn both_discs(@builtin(position) pixel: vec4f) -> Discs {
  let face_size = f32(textureDimensions(face_depth).x / 3u);
  // A map has twice the texels of a face along a side, so that both have equal solid angles.
  let u = pixel.xy / face_size - 1.0;
  let direction = paraboloid_direction(u, 1.0) / (1.0 + dot(u, u));
  return Discs(
    radial_distance(direction, face_size),
    radial_distance(direction * vec3f(1.0, 1.0, -1.0), face_size),
  );
}
