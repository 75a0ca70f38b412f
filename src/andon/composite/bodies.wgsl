// The light of luminous bodies, added where they are seen; and the same alone, for what is done to
// it later.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/gbuffer/clip.wgsl
//!struct AmbientRecord

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var<uniform> ambient: AmbientRecord;
// cd/m² of each pixel, where bodies were traced; or of real shells.
@group(0) @binding(3) var traced: texture_2d<f32>;

// The G-buffer holds the same triangle's depth, computed by the same expression.
const SAME_DEPTH: f32 = 1e-5;
const MOST: vec3f = vec3f(65504.0);

struct BodyCorner {
  @builtin(position) clip: vec4f,
  @location(0) outside: vec3f,
  @location(1) inside: vec3f,
};

struct Pictures {
  @location(0) luminance: vec4f,
  @location(1) bodies: vec4f,
};

fn both(cd_m2: vec3f) -> Pictures {
  let linear = vec4f(min(cd_m2 * ambient.units_per_cd_m2, MOST), 0.0);
  return Pictures(linear, linear);
}

@vertex fn body_corner(
  @location(0) position: vec3f, @location(1) outside: vec3f, @location(2) inside: vec3f,
) -> BodyCorner {
  return BodyCorner(clip_position(position), outside, inside);
}

@fragment fn body_light(in: BodyCorner, @builtin(front_facing) front: bool) -> Pictures {
  let packed = textureLoad(gbuffer, vec2i(in.clip.xy), 0);
  let depth = 1.0 / in.clip.w;
  let body = (packed.w & OBJECT) != 0u && (packed.w >> BODY_SHIFT) > 0u;
  let seen = body && abs(bitcast<f32>(packed.x) - depth) <= SAME_DEPTH * depth;
  return both(select(vec3f(0.0), select(in.inside, in.outside, front), seen));
}

@fragment fn traced_light(@builtin(position) pixel: vec4f) -> Pictures {
  return both(textureLoad(traced, vec2i(pixel.xy), 0).xyz);
}

// Added to what the photograph shows of a shell, unless a virtual thing is before it.
@fragment fn shell_light(@builtin(position) pixel: vec4f) -> Pictures {
  let virtual_thing = (textureLoad(gbuffer, vec2i(pixel.xy), 0).w & OBJECT) != 0u;
  return both(select(textureLoad(traced, vec2i(pixel.xy), 0).xyz, vec3f(0.0), virtual_thing));
}
