// Light of probes on what a view sees of objects: a picture in lux, drawn where the objects are.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/transport/probes/per_pixel.wgsl

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;

@fragment fn probe_picture(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let point = surface_point(textureLoad(gbuffer, vec2i(pixel.xy), 0), pixel.xy);
  // Of a hole there is no place.
  if ((point.flags & VALID) == 0u) { return vec4f(0.0); }
  return vec4f(object_lux(point), 1.0);
}
