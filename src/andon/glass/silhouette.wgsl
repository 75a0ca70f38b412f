// The share of a pixel that is glass: all of those whose middle is. Bodies that have an analytic
// outline exchange this for a smooth one.

//!import andon/glass/solids.wgsl

struct Edge {
  // The ray to trace: the pixel's own, or the nearest that meets the glass.
  ray: Ray,
  coverage: f32,
};

fn silhouette(ray: Ray, pixel_radians: f32) -> Edge {
  return Edge(ray, 1.0);
}
