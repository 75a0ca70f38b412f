// Where a ray meets a body, in the body's own frame.

//!import andon/glass/curvature.wgsl

// Farther than anything: no hit.
const NOWHERE: f32 = 1e30;

struct Hit {
  distance: f32,
  // Out of the glass, unit: what light is refracted at, and of the geometry, the same but on meshes.
  normal: vec3f,
  facet: vec3f,
  // How the normal turns.
  curvature: Curvature,
  // Of meshes: their texture coordinates.
  uv: vec2f,
};
