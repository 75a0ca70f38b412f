// Camera-frame unit ray through `pixel`: the whole sphere, forward in the middle.

//!import andon/gpu/pi.wgsl

fn ray_planar(pixel: vec2f) -> vec3f {
  let azimuth = (pixel.x / view.size.x * 2.0 - 1.0) * PI;
  let elevation = (0.5 - pixel.y / view.size.y) * PI;
  return vec3f(cos(elevation) * sin(azimuth), -sin(elevation), cos(elevation) * cos(azimuth));
}

fn world_ray(pixel: vec2f) -> vec3f {
  return world_direction(ray_planar(pixel));
}

fn pixel_steradians(pixel: vec2f) -> f32 {
  let elevation = (0.5 - pixel.y / view.size.y) * PI;
  return 2.0 * PI * PI * cos(elevation) / (view.size.x * view.size.y);
}
