// How the normal of a surface turns from place to place: dN = C·dP. Spheres and planes alone, of
// which C is a number.

alias Curvature = f32;

const FLAT: Curvature = 0.0;

fn spherical(per_m: f32) -> Curvature {
  return per_m;
}

fn turned(R: mat3x3f, C: Curvature) -> Curvature {
  return C;
}
