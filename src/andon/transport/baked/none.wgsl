// Nothing is baked. Where something is, picture_light.wgsl is in its place.

//!import andon/gbuffer/gbuffer.wgsl

fn baked_lux(point: SurfacePoint, pixel: vec2f) -> vec3f {
  return vec3f(0.0);
}
