// Baked light of a pixel, from the picture of it. Luminous bodies take none, nor do virtual objects
// that lamps do not light, or that have it from probes.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/composite/taking.wgsl
//!import andon/transport/baked/refusing.wgsl

// In lux; alpha is 1 where a map is valid, else 0.
@group(0) @binding(6) var baked_picture: texture_2d<f32>;

fn baked_lux(point: SurfacePoint, pixel: vec2f) -> vec3f {
  let is_body = (point.flags & OBJECT) != 0u && (point.flags >> BODY_SHIFT) > 0u;
  let takes = !is_body && (taking(point) & REFUSING) == 0u;
  return select(vec3f(0.0), textureLoad(baked_picture, vec2i(pixel), 0).xyz, takes);
}
