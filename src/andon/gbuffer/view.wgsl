// Where a pixel looks. `pixel` is the GPU's: centres at +0.5.

//!struct ViewRecord

const PI: f32 = 3.14159265358979;

// Camera-frame ray per unit of depth: planar (z = 1) for pinhole, unit length otherwise.
fn ray_planar(view: ViewRecord, pixel: vec2f) -> vec3f {
  let p = (pixel - view.centre) / view.focal;
  if (view.projection == 0u) { return vec3f(p, 1.0); }
  if (view.projection == 1u) {
    let theta = length(p);
    return vec3f(p * select(1.0, sin(theta) / theta, theta > 1e-6), cos(theta));
  }
  let azimuth = pixel.x / view.size.x * 2.0 * PI - PI;
  let elevation = 0.5 * PI - pixel.y / view.size.y * PI;
  return vec3f(cos(elevation) * sin(azimuth), -sin(elevation), cos(elevation) * cos(azimuth));
}

fn world_direction(view: ViewRecord, direction: vec3f) -> vec3f {
  return (view.world_from_camera * vec4f(direction, 0.0)).xyz;
}

fn world_position(view: ViewRecord, pixel: vec2f, depth: f32) -> vec3f {
  return view.position + world_direction(view, ray_planar(view, pixel)) * depth;
}
