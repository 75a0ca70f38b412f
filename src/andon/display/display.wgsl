// From the picture's linear units to display codes: the same functions as reference.py.

//!struct DisplayRecord

@group(0) @binding(0) var luminance: texture_2d<f32>;
@group(0) @binding(1) var<uniform> display: DisplayRecord;
// Encoded values of a measured response at equal steps of √linear.
@group(0) @binding(2) var curve: texture_2d<f32>;

const SHOULDER_START: f32 = 0.6;
// Light beyond half floats comes as infinity, and ∞/(1 + ∞) would be NaN: this is white as well.
const LARGEST: f32 = 1e30;

fn tone_curve(linear: vec3f) -> vec3f {
  if (display.tone == 0u) { return clamp(linear, vec3f(0.0), vec3f(1.0)); }
  if (display.tone == 2u) {
    let light = clamp(linear, vec3f(0.0), vec3f(LARGEST));
    let most = max(max(light.x, light.y), max(light.z, 1.0));
    return light / most + (1.0 - light / most) * (1.0 - inverseSqrt(most));
  }
  let width = 1.0 - SHOULDER_START;
  let over = clamp((linear - SHOULDER_START) / width, vec3f(0.0), vec3f(LARGEST));
  return select(max(linear, vec3f(0.0)), SHOULDER_START + width * over / (1.0 + over), linear > vec3f(SHOULDER_START));
}

fn curve_encode(linear: vec3f) -> vec3f {
  let last = f32(textureDimensions(curve).x - 1u);
  let place = sqrt(linear) * last;
  let low = min(floor(place), vec3f(last - 1.0));
  let t = place - low;
  let i = vec3i(low);
  return vec3f(
    mix(textureLoad(curve, vec2i(i.x, 0), 0).x, textureLoad(curve, vec2i(i.x + 1, 0), 0).x, t.x),
    mix(textureLoad(curve, vec2i(i.y, 0), 0).y, textureLoad(curve, vec2i(i.y + 1, 0), 0).y, t.y),
    mix(textureLoad(curve, vec2i(i.z, 0), 0).z, textureLoad(curve, vec2i(i.z + 1, 0), 0).z, t.z),
  );
}

fn toned(pixel: vec4f) -> vec3f {
  return tone_curve(textureLoad(luminance, vec2i(pixel.xy), 0).xyz * display.exposure);
}

// One entry point a response: power functions are the dearest thing in this pass.
@fragment fn encode_linear(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  return vec4f(toned(pixel), 1.0);
}

@fragment fn encode_srgb(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let x = toned(pixel);
  let power = 1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055;
  return vec4f(select(power, x * 12.92, x <= vec3f(0.0031308)), 1.0);
}

@fragment fn encode_gamma(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  return vec4f(pow(toned(pixel), vec3f(1.0 / display.gamma)), 1.0);
}

@fragment fn encode_curve(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  return vec4f(curve_encode(toned(pixel)), 1.0);
}
