const LIMIT: f32 = 65504.0;

// NaN and negative light compare false and become 0; infinity becomes the limit.
fn usable(light: vec3f) -> vec3f {
  return select(vec3f(0.0), min(light, vec3f(LIMIT)), light > vec3f(0.0));
}
