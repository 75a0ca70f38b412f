// Each sample's shadow as hard as its texels.

fn soft_sample_share(point: Receiver, place: vec2f) -> f32 {
  let texel = clamp(vec2i(place), vec2i(0), vec2i(i32(SOFT_MAP_SIZE) - 1));
  let side = select(-1.0, 1.0, point.reach.z >= 0.0);
  let stored = textureLoad(soft_paraboloids, texel, point.layer + select(0, 1, side < 0.0), 0).x;
  let lit = plane_is_nearer(point, (vec2f(texel) + 0.5) * (2.0 / SOFT_MAP_SIZE) - 1.0, side, stored);
  return select(0.0, 1.0, lit);
}
