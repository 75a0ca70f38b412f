// Where a pixel looks. The shader that imports this declares `view`, its ViewRecord; the
// projection is exchanged for the view's own.

//!struct ViewRecord
//!import andon/gbuffer/projections/pinhole.wgsl

fn world_direction(direction: vec3f) -> vec3f {
  return view.world_right * direction.x + view.world_down * direction.y + view.world_forward * direction.z;
}

fn world_position(pixel: vec2f, depth: f32) -> vec3f {
  return view.position + world_ray(pixel) * depth;
}
