// Hard shadows: the texel that the receiver falls into decides.

// See `Receiver`.
const PARABOLOID_LIFT_TEXELS: f32 = 1.0;

fn nearest_texel(place: vec2f) -> vec2i {
  return clamp(vec2i(place), vec2i(0), vec2i(i32(MAP_SIZE) - 1));
}

fn paraboloid_share(point: Receiver, place: vec2f) -> f32 {
  // A disc lies within its map: only its rim can round up to one texel too many.
  let texel = min(vec2i(place), vec2i(i32(MAP_SIZE) - 1));
  return select(0.0, 1.0, paraboloid_texel_lit(point, texel));
}

fn spot_share(point: Receiver, place: vec2f) -> f32 {
  return select(0.0, 1.0, spot_texel_lit(point, nearest_texel(place)));
}

fn directional_share(point: Receiver, place: vec2f) -> f32 {
  return select(0.0, 1.0, directional_texel_lit(point, nearest_texel(place)));
}
