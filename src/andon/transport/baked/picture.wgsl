// Baked light on what a view sees: a picture in lux; alpha is 1 where a map sees the surface.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/transport/baked/baked.wgsl

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;

@fragment fn baked_picture(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let point = surface_point(textureLoad(gbuffer, vec2i(pixel.xy), 0), pixel.xy);
  // Of a hole there is no place.
  if ((point.flags & VALID) == 0u) { return vec4f(0.0); }
  return projected_lux(point.position, point.normal);
}
