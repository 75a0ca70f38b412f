// Unit vectors in two signed 16-bit numbers: the octahedral map of Meyer et al. 2010 and
// Cigolle et al. 2014 (section 2). Largest error at 2×16 bits: 6.5e-5 rad, which is half a step of
// 1/32767 in both numbers, stretched by 3 in the middle of a face.

fn sign_not_zero(v: vec2f) -> vec2f {
  return select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

fn octahedral_folded(p: vec2f) -> vec2f {
  return (1.0 - abs(p.yx)) * sign_not_zero(p);
}

// A direction of any length but 0 as a place in [−1, 1]².
fn octahedral_square(n: vec3f) -> vec2f {
  let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  return select(octahedral_folded(p), p, n.z >= 0.0);
}

fn octahedral_encode(n: vec3f) -> u32 {
  return pack2x16snorm(octahedral_square(n));
}

fn octahedral_decode(code: u32) -> vec3f {
  let e = unpack2x16snorm(code);
  let z = 1.0 - abs(e.x) - abs(e.y);
  return normalize(vec3f(select(octahedral_folded(e), e, z >= 0.0), z));
}
