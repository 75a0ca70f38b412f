// Each sample's shadow blended over one texel.

fn soft_sample_share(point: Receiver, place: vec2f) -> f32 {
  return gathered_share(soft_paraboloids, SOFT_MAP_SIZE, point, place);
}
