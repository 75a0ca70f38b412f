// The order of light on the GPU, in one pass: surface → direct illuminance → composite.
//
// One pass instead of three, because on a software rasteriser writing a picture and reading it
// back costs as much as two lamps. `illuminance_map` is the same without the composite, for when
// the illuminance itself is wanted.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/transport/direct/direct.wgsl
//!import andon/composite/composite.wgsl
//!import andon/composite/curves.wgsl
//!import andon/composite/receivers.wgsl
//!import andon/transport/baked/none.wgsl

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var<uniform> ambient: AmbientRecord;
// The captured picture, linear; where E0 or ρ is a picture: what is left of it after dimming; where
// surfaces have curves: in their lux, and in alpha which curve a pixel has, −1: none.
@group(0) @binding(3) var captured: texture_2d<f32>;
// Where E0 or ρ is a picture: what one lux adds.
@group(0) @binding(4) var per_lux: texture_2d<f32>;
// Of the materials of virtual objects, MAX_OBJECT_MATERIALS of them: cd/m² that they emit, and
// (taking.wgsl) what light they take.
@group(0) @binding(5) var<uniform> emitted: array<vec4f, 4096>;
// Where something is baked, binding 6 is the picture of it; where surfaces have curves, binding 7 is
// their table.

fn added_lux(point: SurfacePoint, pixel: vec2f) -> vec3f {
  let bias = select(direct.bias_real_m, direct.bias_object_m, (point.flags & OBJECT) != 0u);
  let all = illuminance(point.position, point.normal, bias, point.flags >> BODY_SHIFT);
  let lux = received_lux(point, all) + baked_lux(point, pixel);
  return select(vec3f(0.0), lux, (point.flags & VALID) != 0u);
}

// The pictures below are half floats: what exceeds them is far beyond any display's white.
const MOST: vec3f = vec3f(65504.0);

fn objects(point: SurfacePoint, pixel: vec2f, lux: vec3f, real: vec3f) -> vec3f {
  let material = min((point.flags >> MATERIAL_SHIFT) & 0xffffu, 4095u);
  let received = standing_lux(point, pixel) + lux;
  let virtual_linear = object_linear(point.reflectance, emitted[material].xyz, received, ambient);
  return select(real, virtual_linear, (point.flags & OBJECT) != 0u);
}

fn point_at(pixel: vec2f) -> SurfacePoint {
  return surface_point(textureLoad(gbuffer, vec2i(pixel), 0), pixel);
}

@fragment fn relit(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let lux = added_lux(point_at(pixel.xy), pixel.xy);
  let light = textureLoad(captured, vec2i(pixel.xy), 0).xyz;
  return vec4f(min(relit_linear(light, lux, ambient), MOST), 1.0);
}

@fragment fn relit_with_objects(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let point = point_at(pixel.xy);
  let lux = added_lux(point, pixel.xy);
  let light = textureLoad(captured, vec2i(pixel.xy), 0).xyz;
  return vec4f(min(objects(point, pixel.xy, lux, relit_linear(light, lux, ambient)), MOST), 1.0);
}

@fragment fn relit_with_maps(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let point = point_at(pixel.xy);
  let lux = added_lux(point, pixel.xy);
  let at = vec2i(pixel.xy);
  let real = relit_by_maps(textureLoad(captured, at, 0).xyz, textureLoad(per_lux, at, 0).xyz, lux);
  return vec4f(min(objects(point, pixel.xy, lux, real), MOST), 1.0);
}

@fragment fn relit_with_curves(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let point = point_at(pixel.xy);
  let lux = added_lux(point, pixel.xy);
  let at = vec2i(pixel.xy);
  let light = textureLoad(captured, at, 0);
  let real = relit_by_curve(light.xyz, textureLoad(per_lux, at, 0).xyz, lux, light.w);
  return vec4f(min(objects(point, pixel.xy, lux, real), MOST), 1.0);
}

// Metres: light is asked for off the glass, since a ball hides lamps from what is inside it.
const OFF_GLASS_M: f32 = 2e-4;

// What sticks to glass reflects this; the G-buffer is that of the glass. Probes have captured some
// lamps' light, which stands in `object_lux` then.
@fragment fn sticker_light(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let point = point_at(pixel.xy);
  let position = point.position + OFF_GLASS_M * point.normal;
  let lux = illuminance(position, point.normal, direct.bias_object_m, 0u);
  let all = ambient.object_lux + lux - captured_lux(point.normal);
  let light = object_linear(vec3f(1.0), vec3f(0.0), all, ambient);
  return vec4f(select(vec3f(0.0), min(light, MOST), (point.flags & VALID) != 0u), 1.0);
}

@fragment fn illuminance_map(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  return vec4f(added_lux(point_at(pixel.xy), pixel.xy), 1.0);
}
