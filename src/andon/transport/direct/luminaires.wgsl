// Lamps with a measured distribution: a point lamp times a table over γ (rows) and C (columns).

// Intensities relative to each lamp's maximum, tables one after the other.
@group(1) @binding(8) var<storage, read> distributions: array<f32>;

//!import andon/gpu/pi.wgsl

// Bilinear in the angles; the last column is the first again.
fn relative_intensity(first: i32, rows: i32, columns: i32, local: vec3f) -> f32 {
  let down = atan2(length(local.xy), local.z) * (1.0 / PI) * f32(rows - 1);
  // The angle of nothing is undefined: straight down or up, all planes are one.
  let turn = atan2(local.y, select(local.x, 1e-20, local.x == 0.0)) / (2.0 * PI);
  let along = (turn - floor(turn)) * f32(columns - 1);
  let row = clamp(i32(down), 0, rows - 2);
  let column = clamp(i32(along), 0, columns - 2);
  let at = first + row * columns + column;
  let share = vec2f(along - f32(column), down - f32(row));
  let upper = mix(distributions[at], distributions[at + 1], share.x);
  let lower = mix(distributions[at + columns], distributions[at + columns + 1], share.x);
  return mix(upper, lower, share.y);
}

fn goniometric_illuminance(
  lamp: i32, layer: i32, first: i32, rows: i32, columns: i32, position: vec3f, normal: vec3f, bias: f32,
) -> vec3f {
  let record = lamps[lamp];
  let reach = position - record.position;
  let local = vec3f(dot(reach, record.right), dot(reach, record.down), dot(reach, record.axis));
  let relative = relative_intensity(first, rows, columns, local);
  return light_of_point(lamp, layer, position, normal, bias, relative);
}
