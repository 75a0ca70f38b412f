// Four texels around a place in the map, each lit or not, weighted by how near they are.

fn bilinear(lit: vec4<bool>, place: vec2f, corner: vec2i) -> f32 {
  let f = clamp(place - 0.5 - vec2f(corner), vec2f(0.0), vec2f(1.0));
  let share = select(vec4f(0.0), vec4f(1.0), lit);
  let rows = mix(share.xz, share.yw, f.x);
  return mix(rows.x, rows.y, f.y);
}
