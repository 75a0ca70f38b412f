// Rims of one or two pixels that no map sees take the light of what lies beside them in the
// picture; rims.py has the rule. What is farther from covered surface stays without light.

//!import andon/gbuffer/gbuffer.wgsl
//!struct BakedSettings

const REACH: i32 = 2;
const ACROSS: i32 = 2 * REACH + 1;
const LEAST_ALIKE: f32 = 0.05;

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var<uniform> settings: BakedSettings;

@fragment fn baked_rims(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  let own = textureLoad(picture, place, 0);
  let point = surface_point(textureLoad(gbuffer, place, 0), pixel.xy);
  let is_bare = own.w == 0.0 && (point.flags & VALID) != 0u;
  let end = vec2i(textureDimensions(picture)) - 1;
  var total = vec4f(0.0);
  for (var k = 0; k < select(0, ACROSS * ACROSS, is_bare); k++) {
    let at = clamp(place + vec2i(k % ACROSS, k / ACROSS) - REACH, vec2i(0), end);
    let tap = textureLoad(picture, at, 0);
    let beside = surface_point(textureLoad(gbuffer, at, 0), vec2f(at) + 0.5);
    let alike = LEAST_ALIKE + max(dot(point.normal, beside.normal), 0.0);
    let away = distance(point.position, beside.position) / settings.depth_tolerance_m;
    // Of a hole there is no place.
    total += select(0.0, alike / (1.0 + away * away), tap.w > 0.0) * vec4f(tap.xyz, 1.0);
  }
  return vec4f(select(own.xyz, total.xyz / max(total.w, 1e-30), total.w > 0.0), own.w);
}
