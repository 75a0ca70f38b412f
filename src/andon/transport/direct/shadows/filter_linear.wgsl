// Shadows blended over one texel.

//!import andon/transport/direct/shadows/blend.wgsl
//!import andon/transport/direct/shadows/gather.wgsl

// See `Receiver`.
const PARABOLOID_LIFT_TEXELS: f32 = 1.0;

fn paraboloid_share(point: Receiver, place: vec2f) -> f32 {
  return gathered_share(paraboloids, MAP_SIZE, point, place);
}
