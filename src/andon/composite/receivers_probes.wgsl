// Some virtual objects stand in the light of probes, instead of E0. What the probes have captured
// of the sky does not come to them from the sky once more.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/composite/taking.wgsl

// In lux, dimmed, drawn where such objects are.
@group(2) @binding(0) var probe_picture: texture_2d<f32>;

fn received_lux(point: SurfacePoint, lux: vec3f) -> vec3f {
  let own = taking(point);
  let rest = select(lux, lux - captured_lux(point.normal), (own & PROBES) != 0u);
  return select(rest, vec3f(0.0), (own & NO_LAMPS) != 0u);
}

fn standing_lux(point: SurfacePoint, pixel: vec2f) -> vec3f {
  let lux = textureLoad(probe_picture, vec2i(pixel), 0).xyz;
  return select(ambient.object_lux, lux, (taking(point) & PROBES) != 0u);
}
