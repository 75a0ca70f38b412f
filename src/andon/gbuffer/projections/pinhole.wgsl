// Camera-frame ray per unit of depth through `pixel` (GPU convention: centres at +0.5).

fn ray_planar(pixel: vec2f) -> vec3f {
  return vec3f((pixel - view.centre) / view.focal, 1.0);
}

// The same in world axes, as three products: what every pixel of every frame does.
fn world_ray(pixel: vec2f) -> vec3f {
  return view.ray_origin + pixel.x * view.ray_column + pixel.y * view.ray_row;
}

// Solid angle of a pixel: its area in the plane at depth 1, seen at a slant.
fn pixel_steradians(pixel: vec2f) -> f32 {
  let slant = inverseSqrt(dot(ray_planar(pixel), ray_planar(pixel)));
  return slant * slant * slant / (view.focal.x * view.focal.y);
}
