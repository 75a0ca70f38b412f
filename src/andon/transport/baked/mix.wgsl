// The texels of a moment under the lamps' present shares: what lookup.wgsl reads. Drawn when shares
// or moment change; lamps are kept apart, so that each may flicker by itself.

//!import andon/transport/baked/settings.wgsl

// x, y as in lookup.wgsl; z: normal z in the low half
@group(0) @binding(0) var baked_surface: texture_2d<u32>;
// A layer each lamp.
@group(0) @binding(1) var baked_lamps: texture_2d_array<f32>;
// Four lamps each; from the lamp's stored units to those of the sum.
@group(0) @binding(2) var<uniform> baked_shares: array<vec4f, 64>;

@fragment fn baked_mix(@builtin(position) pixel: vec4f) -> @location(0) vec4u {
  let at = vec2i(pixel.xy);
  var lux = vec3f(0.0);
  for (var lamp = 0; lamp < BAKED_LAMPS; lamp++) {
    lux += baked_shares[lamp >> 2][lamp & 3] * textureLoad(baked_lamps, at, lamp, 0).xyz;
  }
  let here = textureLoad(baked_surface, at, 0);
  let red = pack2x16float(vec2f(0.0, lux.x));
  return vec4u(here.xy, (here.z & 0xffffu) | (red & 0xffff0000u), pack2x16float(lux.yz));
}
