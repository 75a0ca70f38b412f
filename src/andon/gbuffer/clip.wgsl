// Where a point of the world lies in the clip space of a pinhole view. The shader that imports this
// declares `view`.

//!import andon/gbuffer/view.wgsl

fn clip_position(position: vec3f) -> vec4f {
  let p = (view.camera_from_world * vec4f(position, 1.0)).xyz;
  let image = (view.focal * p.xy + (view.centre - 0.5 * view.size) * p.z) * 2.0 / view.size;
  // Reversed infinite depth: near/z, so that float32 keeps its relative precision far away.
  return vec4f(image.x, -image.y, view.near_m, p.z);
}
