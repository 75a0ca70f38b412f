// What sticks to a body.

//!import andon/glass/backdrops/bindings.wgsl

// Reflectance times cover (premultiplied), and cover; `steps`: columns are what uv moves by for a
// step of one pixel. A body without a sticker has cover 0.
fn sticker_at(solid: i32, uv: vec2f, steps: mat2x2f) -> vec4f {
  let record = backdrops[solid];
  let source = pyramid_at(record.sticker, record.sticker_levels, record.sticker_repeats > vec2f(0.0));
  let size = record.sticker.zw;
  let texels = mat2x2f(steps[0] * size, steps[1] * size);
  return sampled(atlas, source, uv * size, texels);
}
