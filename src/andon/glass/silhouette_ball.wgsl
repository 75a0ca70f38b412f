// The share of a pixel that is a ball alone, smooth over the one pixel around its outline.

//!import andon/glass/solids.wgsl

struct Edge {
  ray: Ray,
  coverage: f32,
};

// Of the radius: rays that are traced pass nearer than this to the middle. Beyond it float32 knows
// no longer whether they meet the ball.
const WITHIN: f32 = 0.99999;

// Less is no glass: light times coverage has no digits left in a half float, and is divided again.
const LEAST: f32 = 0.03125;

fn silhouette(ray: Ray, pixel_radians: f32) -> Edge {
  let to = solids[0].centre - ray.origin;
  let radius = solids[0].size.x;
  let along = dot(to, ray.direction);
  let aside = along * ray.direction - to;
  let off = length(aside);
  // sin of the angles of outline and ray; over a pixel they differ as the angles times the cosine.
  let distance = length(to);
  let slope = sqrt(max(distance * distance - radius * radius, 0.0));
  let inwards = (radius - off) / max(slope * pixel_radians, 1e-30);
  let coverage = select(0.0, clamp(inwards + 0.5, 0.0, 1.0), along > 0.0);
  // The nearest ray that meets the ball: towards where this one passes, drawn in.
  let drawn = to + aside * min(WITHIN * radius / max(off, 1e-30), 1.0);
  let nearest = select(normalize(drawn), ray.direction, off <= WITHIN * radius);
  return Edge(Ray(ray.origin, nearest), select(0.0, coverage, coverage >= LEAST));
}
