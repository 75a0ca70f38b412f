// Light as it was: what of it glares behind a see-through display, and all of it beside its glare.

//!import andon/glare/usable.wgsl
//!import andon/glare/scale.wgsl

@group(0) @binding(0) var light: texture_2d<f32>;
@group(0) @binding(1) var other: texture_2d<f32>;

// Light without that of `other`.
@fragment fn light_without(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  let all_of_it = textureLoad(light, place, 0);
  let rest = usable(all_of_it.rgb) - usable(OTHER_UNIT * textureLoad(other, place, 0).rgb);
  return vec4f(max(rest, vec3f(0.0)), all_of_it.a);
}

// All of it, to be added to the glare.
@fragment fn all_light(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let all_of_it = textureLoad(light, vec2i(pixel.xy), 0);
  return vec4f(usable(all_of_it.rgb), all_of_it.a);
}
