// Light of the frame where a place is seen. The shader that imports this declares `view`.

//!import andon/gbuffer/view.wgsl
//!import andon/glass/backdrops/bindings.wgsl
//!import andon/glass/backdrops/seen.wgsl
//!import andon/glass/backdrops/projections/pinhole.wgsl

// World vectors in the camera's frame.
fn camera_direction(v: vec3f) -> vec3f {
  return vec3f(dot(v, view.world_right), dot(v, view.world_down), dot(v, view.world_forward));
}

// `place` from the eye, and what it moves by for a step of one pixel; `beside`: it is a direction.
// Off the picture the nearest pixel of its border counts.
fn frame_light(place: vec3f, moved: mat2x3f, distance: f32, beside: bool) -> Seen {
  let p = camera_direction(place);
  if (!is_seen(p)) { return nothing_seen(); }
  let steps = mat2x2f(
    moved_pixel(p, camera_direction(moved[0])),
    moved_pixel(p, camera_direction(moved[1])),
  );
  let size = vec2i(view.size);
  let levels = min(8, 32 - i32(countLeadingZeros(u32(max(size.x, size.y) - 1))));
  let source = Pyramid(vec2i(0), size, levels, vec2<bool>(WIDTH_REPEATS, false));
  // Far off the picture whole numbers end.
  let pixel = clamp(pixel_of(p), vec2f(-1e6), vec2f(1e6));
  return Seen(sampled(frame_levels, source, pixel, steps).xyz, distance, false, beside);
}
