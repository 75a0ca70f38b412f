// The veil on its way out: cells of level 1 → blocks → pixels. Alpha is what stays in a pixel.

//!import andon/glare/whole_picture/numbers.wgsl
//!import andon/glare/whole_picture/usable.wgsl

@group(0) @binding(0) var veil: texture_2d<f32>;
// Place (xy) of each block in the chart, the chart's share (z) and what stays there of it (w).
@group(0) @binding(1) var places: texture_2d<f32>;
@group(0) @binding(2) var other_veil: texture_2d<f32>;
@group(0) @binding(3) var other_places: texture_2d<f32>;
@group(0) @binding(4) var blocks: texture_2d<f32>;
@group(0) @binding(5) var linear: sampler;
@group(0) @binding(6) var picture: texture_2d<f32>;
// Light of blocks, and what of it they are seen by themselves (w).
@group(0) @binding(7) var lights: texture_2d<f32>;

// Of the quadratic B-spline, the cells around a place, 0 outside.
fn read(cells: texture_2d<f32>, at: vec4f) -> vec4f {
  let end = vec2i(textureDimensions(cells)) - 1;
  let middle = floor(at.xy + 0.5);
  let off = at.xy - middle;
  let before = 0.5 * (0.5 - off) * (0.5 - off);
  let after = 0.5 * (0.5 + off) * (0.5 + off);
  let mid = 0.75 - off * off;
  let own = vec2i(middle);
  var sum = vec3f(0.0);
  for (var j = -1; j <= 1; j++) {
    let share = select(select(mid.y, after.y, j == 1), before.y, j == -1);
    let row = clamp(own + vec2i(0, j), vec2i(1), end - 1);
    sum += share * (before.x * textureLoad(cells, row - vec2i(1, 0), 0).xyz
      + mid.x * textureLoad(cells, row, 0).xyz + after.x * textureLoad(cells, row + vec2i(1, 0), 0).xyz);
  }
  let inside = all(own >= vec2i(1)) && all(own < end);
  return vec4f(select(vec3f(0.0), at.z * sum, inside), at.w);
}

fn own_light(block: vec2i) -> vec4f {
  let own = textureLoad(lights, block, 0);
  var light = own.xyz;
  if (WRAPS) {
    let columns = i32(textureDimensions(lights).x);
    let doubled = block.x < 2 || block.x >= columns - 2;
    // The place at the other side: 0 is columns − 2, 1 is columns − 1.
    let column = (block.x + select(columns - 2, 2, block.x >= columns - 2)) % columns;
    light += select(vec3f(0.0), textureLoad(lights, vec2i(column, block.y), 0).xyz, doubled);
  }
  return vec4f(own.w * light, 0.0);
}

@fragment fn blocks_seen(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let block = vec2i(texel.xy);
  var seen = read(veil, textureLoad(places, block, 0));
  if (HAS_BLOCKS) {
    seen += own_light(block);
  }
  return seen;
}

@fragment fn blocks_seen_by_two(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let block = vec2i(texel.xy);
  return read(veil, textureLoad(places, block, 0))
    + read(other_veil, textureLoad(other_places, block, 0)) + own_light(block);
}

// [3 1]/4 along each axis, as a linear sampler between two blocks gives it.
@fragment fn expand_blocks(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = (0.5 * pixel.xy + 1.0) / vec2f(textureDimensions(blocks));
  return textureSampleLevel(blocks, linear, place, 0.0);
}

// What is added alone.
@fragment fn added(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = (0.5 * pixel.xy + 1.0) / vec2f(textureDimensions(blocks));
  return vec4f(textureSampleLevel(blocks, linear, place, 0.0).xyz, 0.0);
}

@fragment fn copied(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let light = textureLoad(picture, vec2i(pixel.xy), 0);
  return vec4f(usable(light.xyz), light.w);
}
