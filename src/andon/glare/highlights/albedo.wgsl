// How much of even light GGX sends to the eye: the table of albedo.py.

@group(3) @binding(2) var<storage, read> albedos: array<vec2f, 576>;

const SIDE: u32 = 24u;

fn albedo(cosine: f32, alpha: f32, straight: vec3f) -> vec3f {
  let at = sqrt(clamp(vec2f(cosine, alpha), vec2f(0.0), vec2f(1.0))) * f32(SIDE - 1u);
  let low = min(vec2u(at), vec2u(SIDE - 2u));
  let share = at - vec2f(low);
  let first = low.x * SIDE + low.y;
  let upper = mix(albedos[first], albedos[first + 1u], share.y);
  let lower = mix(albedos[first + SIDE], albedos[first + SIDE + 1u], share.y);
  let value = mix(upper, lower, share.x);
  return straight * value.x + value.y;
}
