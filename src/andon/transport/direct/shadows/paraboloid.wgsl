// The dual-paraboloid map: two discs that see all directions (Brabec, Annen & Seidel 2002).
//
//   d unit, hemisphere by the sign of d.z:   u = d.xy / (1 + |d.z|),   texel = (½ + ½u)·size
//
//        ┌─────────┐  ┌─────────┐     |u| = 1 is the seam d.z = 0. Texels outside the disc are
//        │ ╭─────╮ │  │ ╭─────╮ │     filled by the same formula, so they hold the neighbourhood
//        │ │ +z  │ │  │ │ −z  │ │     of the seam on the other side: no texel at the rim has to
//        │ ╰─────╯ │  │ ╰─────╯ │     be looked up in another layer.
//        └─────────┘  └─────────┘

// Direction of a texel's centre, times (1 + |u|²): the length cancels where it is used.
fn paraboloid_direction(u: vec2f, side: f32) -> vec3f {
  return vec3f(2.0 * u, side * (1.0 - dot(u, u)));
}

// Metres across the widest texels of a disc at a distance: those in the middle of the six faces that
// discs are filled from, which are size/2 texels wide.
fn paraboloid_texel_m(distance: f32, size: f32) -> f32 {
  return distance * (4.0 / size);
}
