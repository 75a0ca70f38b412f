// What mirroring virtual objects send to the eye, over the picture of diffuse light, and the
// highlights of lamps alone, from which the sources of glare are found.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/transport/direct/direct.wgsl
//!import andon/glare/highlights/lamps.wgsl
//!import andon/composite/receivers.wgsl
//!struct AmbientRecord

// As in frame.wgsl.
@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var<uniform> ambient: AmbientRecord;
@group(0) @binding(5) var<uniform> emitted: array<vec4f, 4096>;

const MOST: vec3f = vec3f(65504.0);

struct Pictures {
  // Light that is added in rgb, share of what is there that stays in a: blended so.
  @location(0) luminance: vec4f,
  // cd/m² of mirrored lamps.
  @location(1) highlights: vec4f,
};

@fragment fn mirrored_light(@builtin(position) pixel: vec4f) -> Pictures {
  let here = textureLoad(gbuffer, vec2i(pixel.xy), 0);
  let point = surface_point(here, pixel.xy);
  let facet = facet_at(point, here, pixel.xy);
  // No early return: a software rasteriser would draw the rest all the same. Loops do end.
  let mirrors = facet.kind != 0u;
  let slot = min((point.flags >> MATERIAL_SHIFT) & 0xffffu, arrayLength(&finishes) - 1u);
  let lit = mirrors && finishes[slot].takes_lamps > 0.5;
  let lamps_light = lamps_mirrored(facet, direct.bias_object_m, lit);
  let skies = select(vec3f(0.0), skies_mirrored(facet), lit);
  let wide = standing_lux(point, pixel.xy) * (1.0 / PI) + skies;
  let share = diffuse_share(facet);
  let own = emitted[min(slot, 4095u)].xyz * (1.0 - share);
  let added = lamps_light + wide * even_reflectance(facet, facet.straight) + own;
  let luminance = vec4f(min(added * ambient.units_per_cd_m2, MOST), share);
  return Pictures(
    select(vec4f(0.0, 0.0, 0.0, 1.0), luminance, mirrors),
    select(vec4f(0.0), vec4f(lamps_light, 1.0), mirrors),
  );
}
