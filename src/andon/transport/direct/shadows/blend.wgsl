// Four texels decide, each for itself, weighted bilinearly: for maps that are planes.

fn texel_corner(place: vec2f) -> vec2i {
  return clamp(vec2i(floor(place - 0.5)), vec2i(0), vec2i(i32(MAP_SIZE) - 2));
}

fn spot_share(point: Receiver, place: vec2f) -> f32 {
  let corner = texel_corner(place);
  return bilinear(vec4<bool>(
    spot_texel_lit(point, corner),
    spot_texel_lit(point, corner + vec2i(1, 0)),
    spot_texel_lit(point, corner + vec2i(0, 1)),
    spot_texel_lit(point, corner + vec2i(1, 1)),
  ), place, corner);
}

fn directional_share(point: Receiver, place: vec2f) -> f32 {
  let corner = texel_corner(place);
  return bilinear(vec4<bool>(
    directional_texel_lit(point, corner),
    directional_texel_lit(point, corner + vec2i(1, 0)),
    directional_texel_lit(point, corner + vec2i(0, 1)),
    directional_texel_lit(point, corner + vec2i(1, 1)),
  ), place, corner);
}
