// The box of a part of a needle in a fisheye or latlong picture, where great circles bend. The shader
// that imports this declares `view` and `constants`.

//!import andon/glare/quads/quads.wgsl

// Six vertices, and six more for what reaches over the seam of a latlong picture.
fn strip_corner(needle: NeedleRecord, vertex: u32) -> vec4f {
  let theta = 0.5 * (needle.first + needle.last);
  let middle = cos(theta) * needle.source + sin(theta) * needle.along;
  let reach = vec2f(0.5 * (needle.last - needle.first), half_strip(needle));
  return box_clip(cap_box(middle, length(reach) + 1e-5), vertex % 6u, vertex / 6u);
}
