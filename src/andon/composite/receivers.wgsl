// What light virtual objects take: all that there is, standing in the mean of E0. Stands for itself
// where no object says otherwise; else receivers_lamps.wgsl or receivers_probes.wgsl is in its place.

//!import andon/gbuffer/gbuffer.wgsl

fn received_lux(point: SurfacePoint, lux: vec3f) -> vec3f {
  return lux;
}

fn standing_lux(point: SurfacePoint, pixel: vec2f) -> vec3f {
  return ambient.object_lux;
}
