// How the normal of a surface turns from place to place: dN = C·dP. Any surface.

alias Curvature = mat3x3f;

const FLAT: Curvature = mat3x3f(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

// Of a sphere, for its outward normal: 1/radius, negative where glass is outside of the sphere.
fn spherical(per_m: f32) -> Curvature {
  return mat3x3f(per_m, 0.0, 0.0, 0.0, per_m, 0.0, 0.0, 0.0, per_m);
}

// Of a cylinder around `axis`.
fn cylindrical(per_m: f32, axis: vec3f) -> Curvature {
  let a = axis * per_m;
  return spherical(per_m) - mat3x3f(a * axis.x, a * axis.y, a * axis.z);
}

// The same surface turned by R.
fn turned(R: mat3x3f, C: Curvature) -> Curvature {
  return R * C * transpose(R);
}
