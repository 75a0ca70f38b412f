// The quad of a needle in a pinhole picture: a great circle is a straight line there. The shader
// that imports this declares `view` and `constants`.

//!import andon/glare/quads/quads.wgsl

// Clip position of a direction (not unit) of the camera's frame.
fn clip_of_direction(direction: vec3f) -> vec4f {
  let image = 2.0 * (view.focal * direction.xy + view.centre * direction.z) / view.size - direction.z;
  return vec4f(image.x, -image.y, 0.0, direction.z);
}

// Great circles through the corners at one side bend away from the needle: it stays inside.
fn strip_corner(needle: NeedleRecord, vertex: u32) -> vec4f {
  let corner = quad_corner(vertex);
  let theta = mix(needle.first, needle.last, corner.x);
  let normal = cross(needle.source, needle.along);
  let side = (2.0 * corner.y - 1.0) * tan(half_strip(needle));
  let direction = cos(theta) * needle.source + sin(theta) * needle.along + side * normal;
  return clip_of_direction(direction);
}
