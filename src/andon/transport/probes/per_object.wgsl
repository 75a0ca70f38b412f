// Light was looked up at the middle of each object; its coefficients stand in the row of each of
// the object's materials.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/transport/probes/irradiance.wgsl

fn object_lux(point: SurfacePoint) -> vec3f {
  let material = i32((point.flags >> MATERIAL_SHIFT) & 0xffffu);
  return max(irradiance(material, point.normal), vec3f(0.0));
}
