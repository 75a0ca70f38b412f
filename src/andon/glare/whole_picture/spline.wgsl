// Blocks of the picture → cells of level 1 of a chart: each cell looks for the blocks around it.
//
// Gathered, not scattered, but with the weights that a block gives: they sum to 1 for each block.

//!import andon/glare/whole_picture/numbers.wgsl

@group(0) @binding(0) var blocks: texture_2d<f32>;
@group(0) @binding(1) var roots: texture_2d<f32>;
// First block (xy) of a cell's window; for `gathered` its place less the cell's (zw), for
// `gathered_exactly` the numbers of columns and rows (zw).
@group(0) @binding(2) var windows: texture_2d<f32>;
// For `gathered` what a column (xy) and a row (zw) of blocks add to the place, for
// `gathered_exactly` the place (xy) of each block.
@group(0) @binding(3) var places: texture_2d<f32>;

// The quadratic B-spline at a distance, along both axes.
fn spline(distance: vec2f) -> f32 {
  let outer = max(1.5 - abs(distance), vec2f(0.0));
  let inner = max(0.5 - abs(distance), vec2f(0.0));
  let along = 0.5 * outer * outer - 1.5 * inner * inner;
  return along.x * along.y;
}

// Light of a block on a cell at a distance.
fn light_of(block: vec2i, distance: vec2f) -> vec3f {
  return spline(distance) * textureLoad(blocks, block, 0).xyz;
}

// Where the chart is flat within a window, to a fiftieth of a cell. Four columns at a time.
@fragment fn gathered(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let cell = vec2i(texel.xy);
  let window = textureLoad(windows, cell, 0);
  let steps = textureLoad(places, cell, 0);
  var sum = vec3f(0.0);
  for (var j = 0; j < WINDOW.y; j++) {
    for (var i = 0; i < WINDOW.x; i += 4) {
      let block = vec2i(window.xy) + vec2i(i, j);
      let distance = window.zw + f32(i) * steps.xy + f32(j) * steps.zw;
      sum += light_of(block, distance)
        + light_of(block + vec2i(1, 0), distance + steps.xy)
        + light_of(block + vec2i(2, 0), distance + 2.0 * steps.xy)
        + light_of(block + vec2i(3, 0), distance + 3.0 * steps.xy);
    }
  }
  return vec4f(sum, textureLoad(roots, cell, 0).x);
}

// Anywhere; columns go round.
@fragment fn gathered_exactly(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let cell = vec2i(texel.xy);
  let window = vec4i(textureLoad(windows, cell, 0));
  let columns = i32(textureDimensions(blocks).x);
  var sum = vec3f(0.0);
  for (var j = 0; j < window.w; j++) {
    for (var i = 0; i < window.z; i++) {
      let block = vec2i((window.x + i) % columns, window.y + j);
      let distance = textureLoad(places, block, 0).xy - vec2f(cell);
      sum += spline(distance) * textureLoad(blocks, block, 0).xyz;
    }
  }
  return vec4f(sum, textureLoad(roots, cell, 0).x);
}
