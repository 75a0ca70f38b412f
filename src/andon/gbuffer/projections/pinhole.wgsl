// Camera-frame ray per unit of depth through `pixel` (GPU convention: centres at +0.5).

fn ray_planar(pixel: vec2f) -> vec3f {
  return vec3f((pixel - view.centre) / view.focal, 1.0);
}
