// Camera-frame unit ray through `pixel`: equidistant, image radius = focal·θ.

fn ray_planar(pixel: vec2f) -> vec3f {
  let p = (pixel - view.centre) / view.focal;
  let theta = length(p);
  return vec3f(p * select(1.0, sin(theta) / theta, theta > 1e-6), cos(theta));
}

fn world_ray(pixel: vec2f) -> vec3f {
  return world_direction(ray_planar(pixel));
}

fn pixel_steradians(pixel: vec2f) -> f32 {
  let theta = length((pixel - view.centre) / view.focal);
  return abs(select(1.0, sin(theta) / theta, theta > 1e-6)) / (view.focal.x * view.focal.y);
}
