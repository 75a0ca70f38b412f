// Hard shadows: the texel that the receiver falls into decides.

fn nearest_texel(place: vec2f, lamp: i32) -> vec2i {
  return clamp(vec2i(place), vec2i(0), vec2i(i32(lamps[lamp].map_size) - 1));
}

fn paraboloid_share(point: Receiver, place: vec2f) -> f32 {
  return select(0.0, 1.0, paraboloid_texel_lit(point, nearest_texel(place, point.lamp)));
}

fn spot_share(point: Receiver, place: vec2f) -> f32 {
  return select(0.0, 1.0, spot_texel_lit(point, nearest_texel(place, point.lamp)));
}

fn directional_share(point: Receiver, place: vec2f) -> f32 {
  return select(0.0, 1.0, directional_texel_lit(point, nearest_texel(place, point.lamp)));
}
