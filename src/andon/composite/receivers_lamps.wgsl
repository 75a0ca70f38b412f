// Some virtual objects take no light of lamps.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/composite/taking.wgsl

fn received_lux(point: SurfacePoint, lux: vec3f) -> vec3f {
  return select(lux, vec3f(0.0), (taking(point) & NO_LAMPS) != 0u);
}

fn standing_lux(point: SurfacePoint, pixel: vec2f) -> vec3f {
  return ambient.object_lux;
}
