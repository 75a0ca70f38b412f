// The veil and the halo of known sources, additive (reference.py): one instance for each ring of each
// source; those whose rings are the whole picture in one pass.

//!import andon/glare/quads/quads.wgsl
//!import andon/glare/per_source/constants.wgsl
//!struct VeilSource

const TURN: f32 = 6.28318530717959;
const FAR: u32 = 2u;
const HALO: u32 = 3u;
// A ring that ends beyond this chord has no box.
const WHOLE: f32 = 1.4;
const LARGEST: f32 = 65504.0;

@group(0) @binding(0) var<uniform> view: ViewRecord;
@group(0) @binding(1) var<storage> sources: array<VeilSource>;
// Source, ring.
@group(0) @binding(2) var<storage> instances: array<vec2u>;
// Corners of a cell: at its row and column, its next column, and both of the next row. Layer 0 has
// V·q², layer 1 radians from the outline.
@group(0) @binding(3) var tables: texture_2d_array<f32>;
// Edge at a step and the next one, row at both.
@group(0) @binding(4) var edges: texture_2d<f32>;
@group(0) @binding(5) var halos: texture_2d<f32>;
// Of sources in the whole picture: first circle, the one after the last; the same of outlines.
@group(0) @binding(6) var<uniform> whole: vec4u;

// m − m0, m0 − f, and the row of the atlas.
struct TablePlace {
  beyond: f32,
  depth: f32,
  row: i32,
  part: f32,
};

//!import andon/glare/per_source/circle.wgsl

struct SourceQuad {
  @builtin(position) position: vec4f,
  @location(0) @interpolate(flat) drawn: vec2u,
};

@vertex fn source_quad(
  @builtin(vertex_index) vertex: u32,
  @builtin(instance_index) instance: u32,
) -> SourceQuad {
  let drawn = instances[instance];
  let source = sources[drawn.x];
  let end = source.ends[drawn.y];
  var box = vec4f(0.0, 0.0, view.size);
  if (end < WHOLE) {
    let cap = cap_box(source.direction, 2.0 * asin(0.5 * end));
    box = vec4f(floor(cap.xy) - 1.0, ceil(cap.zw) + 1.0);
    // Wider than a latlong picture it would meet itself beyond the seam.
    let whole = box.z - box.x >= view.size.x;
    box = vec4f(select(box.x, 0.0, whole), box.y, select(box.z, view.size.x, whole), box.w);
  }
  return SourceQuad(box_clip(box, vertex % 6u, vertex / 6u), drawn);
}

// Value of a layer, and what those of layer 0 are multiplied by.
fn table_at(source: VeilSource, off: vec3f, layer: i32) -> vec2f {
  let place = place_of(source, off);
  let q = 1.0 + abs(place.beyond) * source.per_step;
  let octaves = log2(q);
  let inside = EDGE - EDGE * octaves / log2(1.0 + place.depth * source.per_step);
  let outside = EDGE + source.per_octave * octaves + 0.25 * FAR_COLUMNS * place.beyond * place.beyond;
  let column = clamp(select(outside, inside, place.beyond < 0.0), 0.0, LAST_COLUMN);
  let first = min(floor(column), LAST_COLUMN - 1.0);
  let cell = textureLoad(tables, vec2i(i32(first), place.row), layer, 0);
  let rows = mix(cell.xy, cell.zw, place.part);
  return vec2f(mix(rows.x, rows.y, column - first), select(1.0 / (q * q), 1.0, place.beyond < 0.0));
}

// 1 where the pixel is of that ring.
fn in_ring(source: VeilSource, direction: vec3f, ring: u32) -> f32 {
  let away = length(direction - source.direction);
  return select(0.0, 1.0, away >= source.starts[ring] && away < source.ends[ring]);
}

fn halo_at(source: VeilSource, direction: vec3f) -> vec3f {
  let place = table_at(source, direction - source.direction, 1).x * (HALO_LAST / source.halo_end);
  let first = min(floor(place), HALO_LAST - 1.0);
  let low = textureLoad(halos, vec2i(i32(first), 0), 0).xyz;
  let high = textureLoad(halos, vec2i(i32(first) + 1, 0), 0).xyz;
  return select(vec3f(0.0), mix(low, high, place - first), place < HALO_LAST);
}

fn veil_at(source: VeilSource, direction: vec3f) -> f32 {
  let value = table_at(source, direction - source.direction, 0);
  return value.x * value.y;
}

// One sample of a pixel: of all sources that are drawn in the whole picture (their number is a uniform,
// so that records are read once for all pixels), or of one.
@fragment fn whole_light(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let direction = normalize(ray_planar(pixel.xy));
  let range = whole_range();
  var sum = vec3f(0.0);
  for (var i = range.x; i < range.y; i++) {
    let veil = veil_at(sources[i], direction);
    sum += sources[i].light * (veil * in_ring(sources[i], direction, FAR));
  }
  return vec4f(min(sum, vec3f(LARGEST)), 0.0);
}

@fragment fn far_light(quad: SourceQuad) -> @location(0) vec4f {
  let direction = normalize(ray_planar(quad.position.xy));
  let source = sources[quad.drawn.x];
  let light = source.light * (veil_at(source, direction) * in_ring(source, direction, FAR));
  return vec4f(min(light, vec3f(LARGEST)), 0.0);
}

// Sample k of n along a side, from the middle of the pixel (rings.py).
fn sample_offset(k: u32, n: f32) -> f32 {
  let middle = (f32(k) + 0.5) / n - 0.5;
  return select(0.0, middle * inverseSqrt(max(1.0 - 1.0 / (n * n), 0.5)), n > 1.0);
}

@fragment fn near_light(quad: SourceQuad) -> @location(0) vec4f {
  let source = sources[quad.drawn.x];
  let ring = quad.drawn.y;
  let n = source.samples[ring];
  var sum = vec3f(0.0);
  for (var row = 0u; row < u32(n); row++) {
    for (var column = 0u; column < u32(n); column++) {
      let offset = vec2f(sample_offset(column, n), sample_offset(row, n));
      let direction = normalize(ray_planar(quad.position.xy + offset));
      if (ring == HALO) {
        sum += source.halo * halo_at(source, direction);
      } else {
        sum += source.light * veil_at(source, direction);
      }
    }
  }
  let middle = normalize(ray_planar(quad.position.xy));
  return vec4f(min(sum * (in_ring(source, middle, ring) / (n * n)), vec3f(LARGEST)), 0.0);
}
