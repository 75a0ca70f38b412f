// Where a direction lies in the table of a circle. The shader that imports this declares the rest.

fn place_of(source: VeilSource, off: vec3f) -> TablePlace {
  let row = floor(source.row);
  return TablePlace(length(off) - source.edge, source.edge, i32(row), source.row - row);
}

fn whole_range() -> vec2u {
  return whole.xy;
}
