// The first halving of light.wgsl with a linear sampler: four samples for sixteen loads.
//
// For finite light alone, and away from the border, where a sampler would repeat the last pixel.

@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var factors: texture_2d<f32>;
@group(0) @binding(2) var linear: sampler;

fn sampled(at: vec2f) -> vec3f {
  return textureSampleLevel(source, linear, at / vec2f(textureDimensions(source)), 0.0).xyz;
}

// Between the first two pixels of four the sampler weighs them 1 to 3, between the last 3 to 1.
// Each sample counts by the solid angle in its middle.
fn halved(texel: vec2f, growth: vec2f) -> vec3f {
  let low = 2.0 * texel - 2.75;
  let high = low + vec2f(1.5);
  let across = 0.75 * (growth.x + growth.y);
  let along = 0.75 * (growth.x - growth.y);
  return (1.0 - across) * sampled(low) + (1.0 + along) * sampled(vec2f(high.x, low.y))
    + (1.0 - along) * sampled(vec2f(low.x, high.y)) + (1.0 + across) * sampled(high);
}

@fragment fn halve(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  return vec4f(halved(texel.xy, vec2f(0.0)), 0.0);
}

@fragment fn reduce_blocks(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let factor = textureLoad(factors, vec2i(texel.xy), 0);
  return vec4f(halved(texel.xy, factor.zw) * factor.x, factor.y);
}
