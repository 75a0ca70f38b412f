// Light is looked up where each pixel lies.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/transport/probes/walls_none.wgsl

fn object_lux(point: SurfacePoint) -> vec3f {
  return probe_lux(point.position, point.normal);
}
