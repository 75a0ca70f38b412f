// The boxes of a needle in a fisheye or latlong picture, where great circles bend: one around each
// part of it. The shader that imports this declares `view` and `constants`.

//!import andon/glare/quads/quads.wgsl

const PARTS: u32 = 8u;

// Vertices: PARTS times 6, for the picture and once more for what reaches over a seam.
fn strip_corner(needle: NeedleRecord, vertex: u32) -> StripCorner {
  let part = (vertex / 6u) % PARTS;
  let step = (needle.last - needle.first) / f32(PARTS);
  let theta = needle.first + step * (f32(part) + 0.5);
  let middle = cos(theta) * needle.source + sin(theta) * needle.along;
  let across = needle.half_width + constants.margin;
  let box = cap_box(middle, length(vec2f(0.5 * step, across)) + 1e-5);
  // Boxes overlap; each pixel belongs to one part of the needle.
  let own = needle.first + step * vec2f(f32(part), f32(part + 1u));
  return StripCorner(box_clip(box, vertex % 6u, vertex / (6u * PARTS)), own);
}
