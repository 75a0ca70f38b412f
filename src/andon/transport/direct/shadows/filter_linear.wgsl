// Shadows blended over one texel.

//!import andon/transport/direct/shadows/blend.wgsl

fn paraboloid_share(point: Receiver, place: vec2f) -> f32 {
  let corner = texel_corner(place);
  return bilinear(vec4<bool>(
    paraboloid_texel_lit(point, corner),
    paraboloid_texel_lit(point, corner + vec2i(1, 0)),
    paraboloid_texel_lit(point, corner + vec2i(0, 1)),
    paraboloid_texel_lit(point, corner + vec2i(1, 1)),
  ), place, corner);
}
