// Surfaces with a curve of their own: f of the new light. curve_table.py has the table's form.

// Row 3·curve + channel, a texel for each cell of light: knot, f(knot), slopes below and above it.
@group(0) @binding(7) var curves: texture_2d<f32>;

// Bits of a float that do not tell its cell, as CELL_SHIFT in curve_table.py.
const CELL_SHIFT: u32 = 17u;

fn curve_linear(light: f32, row: i32) -> f32 {
  let cell = i32(bitcast<u32>(max(light, 0.0)) >> CELL_SHIFT) - ambient.first_cell;
  let last = i32(textureDimensions(curves).x) - 1;
  let at = textureLoad(curves, vec2i(clamp(cell, 0, last), row), 0);
  let off = light - at.x;
  return at.y + off * select(at.w, at.z, off < 0.0);
}

// `dimmed` and `per_lux` in lux of the curve; a negative `curve` is none, and they are linear.
fn relit_by_curve(dimmed: vec3f, per_lux: vec3f, added_lux: vec3f, curve: f32) -> vec3f {
  let light = max(dimmed + per_lux * added_lux, min(dimmed, vec3f(0.0)));
  let row = 3 * max(i32(curve), 0);
  let linear = vec3f(
    curve_linear(light.x, row), curve_linear(light.y, row + 1), curve_linear(light.z, row + 2),
  );
  return select(light, max(linear, vec3f(0.0)), curve >= 0.0);
}
