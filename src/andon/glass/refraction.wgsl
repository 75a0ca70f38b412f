// One ray at one boundary. D and N are unit vectors, N against D; ratio = n1/n2, from where the ray
// comes to where it goes.

struct Bend {
  direction: vec3f,
  // Cosines of incidence and of refraction; the second is 0 at total reflection.
  cos_in: f32,
  cos_out: f32,
  total: bool,
};

// Whitted 1980, section 2, for unit vectors: Snell's law. Where nothing is let through, the
// direction is the mirrored one.
fn refracted(D: vec3f, N: vec3f, ratio: f32) -> Bend {
  let c1 = -dot(D, N);
  // 1 − sin² from the cross product: near normal incidence 1 − c1² has no digits left in float32.
  let across = cross(D, N);
  let left = 1.0 - ratio * ratio * dot(across, across);
  let c2 = sqrt(max(left, 0.0));
  let through = ratio * D + (ratio * c1 - c2) * N;
  let total = left <= 0.0;
  return Bend(normalize(select(through, mirrored(D, N), total)), c1, c2, total);
}

fn mirrored(D: vec3f, N: vec3f) -> vec3f {
  return D - 2.0 * dot(D, N) * N;
}

// Share that is mirrored by a dielectric, unpolarised (Born & Wolf 1999, 1.5.2); 1 at total
// reflection, where cos_out is 0.
fn fresnel(cos_in: f32, cos_out: f32, ratio: f32) -> f32 {
  let s = (ratio * cos_in - cos_out) / (ratio * cos_in + cos_out);
  let p = (cos_in - ratio * cos_out) / (cos_in + ratio * cos_out);
  return min(0.5 * (s * s + p * p), 1.0);
}
