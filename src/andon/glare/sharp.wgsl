// Light as it was: what of it glares behind a see-through display, and all of it beside its glare.

@group(0) @binding(0) var light: texture_2d<f32>;
@group(0) @binding(1) var other: texture_2d<f32>;

//!import andon/glare/scale.wgsl

// Light without that of `other`.
@fragment fn light_without(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  return max(textureLoad(light, place, 0) - OTHER_UNIT * textureLoad(other, place, 0), vec4f(0.0));
}

// All of it, to be added to the glare.
@fragment fn all_light(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  return textureLoad(light, vec2i(pixel.xy), 0);
}
