// Where a direction lies in the table of any outline: confocal coordinates (coordinates.py). The
// shader that imports this declares the rest.

fn place_of(source: VeilSource, off: vec3f) -> TablePlace {
  let scale = inverseSqrt(max(1.0 - 0.25 * dot(off, off), 1e-6));
  let x = dot(off, source.right) * scale;
  let across = dot(off, source.down) * scale;
  let y = select(across, 1e-12, abs(across) < 1e-12);
  let f2 = source.focus * source.focus;
  let a = x * x + y * y - f2;
  let root = sqrt(a * a + 4.0 * f2 * y * y);
  let w2 = select(2.0 * f2 * y * y / max(root - a, 1e-37), 0.5 * (a + root), a >= 0.0);
  let m = sqrt(f2 + w2);
  let turns = atan2(y * m, x * sqrt(w2)) / TURN;
  let step = min(fract(turns) * EDGES, EDGES - 1.0);
  // The edge at two steps around, and rows of the table.
  let edge = textureLoad(edges, vec2i(i32(step), i32(source.edge_row)), 0);
  let beside = mix(edge.xz, edge.yw, fract(turns) * EDGES - floor(step));
  let row = min(floor(beside.y), ROWS - 1.0);
  return TablePlace(m - beside.x, beside.x - source.focus, i32(source.row + row), beside.y - row);
}

fn whole_range() -> vec2u {
  return whole.zw;
}
