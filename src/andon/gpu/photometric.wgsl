// Photometric value of light in RGB: quantities.LUMINANCE_WEIGHTS.

fn photometric(light: vec3f) -> f32 {
  return dot(light, vec3f(0.2126, 0.7152, 0.0722));
}
