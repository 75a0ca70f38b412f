// What halo and needles are made of is taken from the pixels of their sources.

//!import andon/glare/gate.wgsl
//!import andon/glare/usable.wgsl
//!import andon/gpu/photometric.wgsl
//!struct TakenShare

@group(0) @binding(0) var light: texture_2d<f32>;
@group(0) @binding(1) var<uniform> share: TakenShare;

// Blended onto the picture: negative.
@fragment fn taken(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let source = usable(textureLoad(light, vec2i(pixel.xy), 0).rgb);
  let value = photometric(source);
  return vec4f(-share.taken * source * gate(value, share.least), 0.0);
}
