// Light that can be summed: NaN and negative values are none, infinity is what a half float holds.

fn usable(light: vec3f) -> vec3f {
  return select(vec3f(0.0), min(light, vec3f(65504.0)), light > vec3f(0.0));
}
