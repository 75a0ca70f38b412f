// The packed surface, 16 bytes a pixel, one read:
//
//   x  depth in metres, f32 bits        z  √reflectance, 3 × unorm8 (√ spends the bits on darks)
//   y  normal, octahedral 2 × snorm16   w  bit 0 valid, 1 virtual object, 8… material, 24… body

//!import andon/gpu/octahedral.wgsl
//!import andon/gbuffer/view.wgsl

const VALID: u32 = 1u;
const OBJECT: u32 = 2u;
const MATERIAL_SHIFT: u32 = 8u;
const BODY_SHIFT: u32 = 24u;

struct SurfacePoint {
  position: vec3f,
  normal: vec3f,
  reflectance: vec3f,
  flags: u32,
};

fn surface_point(packed: vec4u, pixel: vec2f) -> SurfacePoint {
  let root = unpack4x8unorm(packed.z).xyz;
  return SurfacePoint(
    world_position(pixel, bitcast<f32>(packed.x)),
    octahedral_decode(packed.y),
    root * root,
    packed.w,
  );
}
