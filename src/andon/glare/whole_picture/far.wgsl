// Light between all pairs of coarse cells: the cells' light in a row, and a matrix times it.

@group(0) @binding(0) var light: texture_2d<f32>;
@group(0) @binding(1) var other_light: texture_2d<f32>;
// Chart, row and column of the lit cells.
@group(0) @binding(2) var lit: texture_2d<u32>;
// A row per receiving cell, four lit cells a texel.
@group(0) @binding(3) var matrix: texture_2d<f32>;

const STRIP: i32 = 64;

@fragment fn collected(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let cell = vec4i(textureLoad(lit, vec2i(texel.xy), 0));
  let at = cell.zy;
  let one = textureLoad(light, min(at, vec2i(textureDimensions(light)) - 1), 0);
  let other = textureLoad(other_light, min(at, vec2i(textureDimensions(other_light)) - 1), 0);
  return vec4f(select(one, other, cell.x == 1).xyz, 0.0);
}

@fragment fn far(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let size = vec2i(textureDimensions(matrix));
  let row = min(i32(texel.y) * STRIP + i32(texel.x), size.y - 1);
  var sum = vec3f(0.0);
  for (var i = 0; i < size.x; i++) {
    let weights = textureLoad(matrix, vec2i(i, row), 0);
    sum += weights.x * textureLoad(light, vec2i(4 * i, 0), 0).xyz
      + weights.y * textureLoad(light, vec2i(4 * i + 1, 0), 0).xyz
      + weights.z * textureLoad(light, vec2i(4 * i + 2, 0), 0).xyz
      + weights.w * textureLoad(light, vec2i(4 * i + 3, 0), 0).xyz;
  }
  return vec4f(sum, 0.0);
}
