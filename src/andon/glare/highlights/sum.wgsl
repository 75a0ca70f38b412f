// No lamps. The stage exchanges this module for one that names the frame's own lamps.

fn lamps_mirrored(facet: Facet, bias: f32, lit: bool) -> vec3f {
  return vec3f(0.0);
}

fn skies_mirrored(facet: Facet) -> vec3f {
  return vec3f(0.0);
}
