// Light from all sides of a body, in harmonics: what a ray finds that hits nothing.

//!struct EnvironmentRecord
//!import andon/harmonics/harmonics.wgsl

@group(1) @binding(3) var<uniform> environments: array<EnvironmentRecord, 8>;

// Of the frame's white, ≥ 0, in a unit direction.
fn environment_light(solid: i32, direction: vec3f) -> vec3f {
  let c = environments[solid];
  let terms = low_terms(direction);
  let light = vec3f(
    dot(c.red_a, terms.a) + dot(c.red_b, terms.b),
    dot(c.green_a, terms.a) + dot(c.green_b, terms.b),
    dot(c.blue_a, terms.a) + dot(c.blue_b, terms.b),
  );
  return max(light + c.last * terms.c, vec3f(0.0));
}
