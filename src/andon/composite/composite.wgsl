// The photograph under its new light: the same functions as reference.py, in units of the picture
// (cd/m² divided by luminance_per_unit), which half floats hold well.

//!struct AmbientRecord

const INVERSE_PI: f32 = 0.318309886183791;

fn relit_linear(captured: vec3f, added_lux: vec3f, ambient: AmbientRecord) -> vec3f {
  // Less than no light is none: ΔE is negative where light is taken away.
  return captured * max(ambient.dimming + added_lux * ambient.inverse_lux, vec3f(0.0));
}

// Where E0 or ρ is a picture, or dimming is the paper's: both are folded into two pictures,
// what is left of the captured light and what one lux adds to it.
fn relit_by_maps(dimmed: vec3f, per_lux: vec3f, added_lux: vec3f) -> vec3f {
  return max(dimmed + per_lux * added_lux, vec3f(0.0));
}

fn object_linear(reflectance: vec3f, emitted: vec3f, lux: vec3f, ambient: AmbientRecord) -> vec3f {
  return (reflectance * max(lux, vec3f(0.0)) * INVERSE_PI + emitted) * ambient.units_per_cd_m2;
}
