// What is bound for backdrops, group 1: one for each view.

//!struct BackdropRecord
//!import andon/glass/backdrops/pyramids.wgsl

// Pictures of all backdrops and stickers with their coarser levels.
@group(1) @binding(0) var atlas: texture_2d<f32>;
@group(1) @binding(1) var<uniform> backdrops: array<BackdropRecord, 8>;
// The frame before glass with its coarser levels, its corner at 0.
@group(1) @binding(2) var frame_levels: texture_2d<f32>;

fn pyramid_at(corner_size: vec4f, levels: i32, repeats: vec2<bool>) -> Pyramid {
  return Pyramid(vec2i(corner_size.xy), vec2i(corner_size.zw), levels, repeats);
}
