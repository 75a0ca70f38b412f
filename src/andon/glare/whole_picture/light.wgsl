// Light on its way in: pixels → halves → blocks → coarser and coarser cells. Alpha of cells is √w.

//!import andon/glare/whole_picture/numbers.wgsl
//!import andon/glare/whole_picture/usable.wgsl

@group(0) @binding(0) var source: texture_2d<f32>;
// Of blocks, the last of the halvings: solid angle of a pixel by area of a cell, what a block is
// seen of its own light (y), and by how much of itself the solid angle grows with a column and a
// row. Of cells: √w.
@group(0) @binding(1) var factors: texture_2d<f32>;

// 0 beyond the border.
fn light_at(at: vec2i, end: vec2i) -> vec3f {
  let inside = all(at >= vec2i(0)) && all(at <= end);
  return select(vec3f(0.0), usable(textureLoad(source, clamp(at, vec2i(0), end), 0).xyz), inside);
}

// Sum over a block, [1 3 3 1]/4 along each axis. Block 0 is the one beyond the border.
fn halved(place: vec2i, growth: vec2f) -> vec3f {
  let end = vec2i(textureDimensions(source)) - 1;
  let first = 2 * place - 3;
  var sum = vec3f(0.0);
  for (var j = 0; j < 4; j++) {
    let down = select(1.0, 3.0, j == 1 || j == 2) * weight_of_row(first.y + j);
    for (var i = 0; i < 4; i++) {
      let share = down * select(1.0, 3.0, i == 1 || i == 2);
      let size = 1.0 + dot(growth, vec2f(vec2i(i, j)) - 1.5);
      sum += share * size * light_at(first + vec2i(i, j), end);
    }
  }
  return sum / 16.0;
}

@fragment fn halve(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  return vec4f(halved(vec2i(texel.xy), vec2f(0.0)), 0.0);
}

@fragment fn reduce_blocks(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  let factor = textureLoad(factors, place, 0);
  return vec4f(halved(place, factor.zw) * factor.x, factor.y);
}

fn row_of_four(first: vec2i, end: vec2i) -> vec3f {
  return light_at(first, end) + light_at(first + vec2i(3, 0), end)
    + 3.0 * (light_at(first + vec2i(1, 0), end) + light_at(first + vec2i(2, 0), end));
}

// Mean over a cell, [1 3 3 1]/8 along each axis.
@fragment fn reduced(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let end = vec2i(textureDimensions(source)) - 1;
  let place = vec2i(texel.xy);
  let first = 2 * place - MARGIN - 1;
  var sum = vec3f(0.0);
  for (var j = 0; j < 4; j++) {
    sum += select(1.0, 3.0, j == 1 || j == 2) * row_of_four(first + vec2i(0, j), end);
  }
  return vec4f(sum / 64.0, textureLoad(factors, place, 0).x);
}
