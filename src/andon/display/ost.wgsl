// For an optical see-through display: the same functions as ost.py, in the picture's linear units.

//!struct OstRecord

@group(0) @binding(0) var wanted: texture_2d<f32>;
@group(0) @binding(1) var real: texture_2d<f32>;
// The photograph in the dimmed light of the scene without lamps.
@group(0) @binding(2) var unlit: texture_2d<f32>;
@group(0) @binding(3) var<uniform> ost: OstRecord;

const UNCHANGED: f32 = 0.01;
const FLOOR: f32 = 1e-4;

fn differs(a: vec3f, b: vec3f) -> bool {
  return any(abs(a - b) > UNCHANGED * b + FLOOR);
}

fn shown_share(at: vec2i, passes: vec3f) -> vec3f {
  let light = textureLoad(wanted, at, 0).xyz;
  if (ost.compensation == 1u) {
    return clamp((light - passes) / ost.peak, vec3f(0.0), vec3f(1.0));
  }
  let is_virtual = differs(light, textureLoad(real, at, 0).xyz)
    && differs(light, textureLoad(unlit, at, 0).xyz);
  return select(vec3f(0.0), clamp(light / ost.peak, vec3f(0.0), vec3f(1.0)), is_virtual);
}

fn srgb_encode(linear: vec3f) -> vec3f {
  let power = 1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055;
  return select(power, linear * 12.92, linear <= vec3f(0.0031308));
}

fn srgb_decode(encoded: vec3f) -> vec3f {
  let power = pow((encoded + 0.055) / 1.055, vec3f(2.4));
  return select(power, encoded / 12.92, encoded <= vec3f(0.04045));
}

// The nearest of the display's 256 values, so that what is seen is what these codes give.
fn rounded(share: vec3f) -> vec3f {
  return floor(srgb_encode(share) * 255.0 + 0.5) / 255.0;
}

fn real_that_passes(at: vec2i) -> vec3f {
  return ost.transmittance * textureLoad(real, at, 0).xyz;
}

@fragment fn display_codes(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let at = vec2i(pixel.xy);
  return vec4f(rounded(shown_share(at, real_that_passes(at))), 1.0);
}

@fragment fn seen_light(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let at = vec2i(pixel.xy);
  let passes = real_that_passes(at);
  return vec4f(ost.peak * srgb_decode(rounded(shown_share(at, passes))) + passes, 1.0);
}
