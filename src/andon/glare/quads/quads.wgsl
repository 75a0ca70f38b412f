// Rectangles of pixels as two triangles. The shader that imports this declares `view`; cap_box is
// exchanged for the view's own projection.

//!import andon/gbuffer/view.wgsl
//!import andon/glare/quads/pinhole.wgsl

// Corner 0…5 of two triangles, each coordinate 0 or 1.
fn quad_corner(index: u32) -> vec2f {
  return vec2f(f32((0x32u >> index) & 1u), f32((0x2cu >> index) & 1u));
}

// Clip position of a place in the picture, in pixels.
fn clip_of_pixel(pixel: vec2f) -> vec4f {
  let place = pixel / view.size * 2.0 - 1.0;
  return vec4f(place.x, -place.y, 0.0, 1.0);
}

// Clip position of corner 0…5 of `box`. Of a box that reaches over the seam of a latlong picture
// `copy` 1 is the part on the other side; of one that does not it is nothing.
fn box_clip(box: vec4f, corner: u32, copy: u32) -> vec4f {
  let place = mix(box.xy, box.zw, quad_corner(corner));
  let over = select(select(0.0, -view.size.x, box.z > view.size.x), view.size.x, box.x < 0.0);
  let shown = select(vec2f(-1.0), place + vec2f(over, 0.0), over != 0.0);
  return clip_of_pixel(select(place, shown, copy == 1u));
}
