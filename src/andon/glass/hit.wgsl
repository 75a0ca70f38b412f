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
  // Of meshes, the triangle; else −1.
  triangle: i32,
};

// Where on a sticker's picture a point is, −1 where nothing can stick; and columns of what that
// moves by for a step of one pixel.
struct Sticking {
  uv: vec2f,
  steps: mat2x2f,
};

fn nothing_sticks() -> Sticking {
  return Sticking(vec2f(-1.0), mat2x2f(0.0, 0.0, 0.0, 0.0));
}
