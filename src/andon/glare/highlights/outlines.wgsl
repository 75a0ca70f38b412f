// Lamps' outlines, and what is mirrored of them: outlines.py and _of_an_area of reference.py.

//!import andon/glare/highlights/lobes.wgsl
//!import andon/transport/direct/direct.wgsl

const CORNERS: i32 = 16;
// √(2π/(16·sin(2π/16))): a polygon of the same area.
const SAME_AREA: f32 = 1.0130016;

// What an outline holds of a lobe, edge by edge; of GGX also the mean of `weight` over its corners.
struct Held {
  light: vec3f,
  value: vec3f,
  lobe: f32,
  count: f32,
};

// Slopes of the lamp's middle in xy, and 1 in z where the lobe's middle is far from them.
fn lamp_middle(facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  let seen = half_slopes(facet, above_horizon(facet, reach));
  let sine = radius / max(length(reach), radius);
  let size = sine / (2.0 * max(seen.w, 0.05) * seen.z * seen.z * min(facet.alpha.x, facet.alpha.y));
  return vec3f(seen.xy, select(0.0, 1.0, length(seen.xy) > FAR * size));
}

fn with_edge(held: Held, facet: Facet, middle: vec3f, start: vec3f, end: vec3f, light: vec3f) -> Held {
  var sum = held;
  let first = above_horizon(facet, start);
  let last = above_horizon(facet, end);
  if (facet.kind == PHONG) {
    sum.light += light * phong_edge_share(phong_plane(facet, first), phong_plane(facet, last), facet.exponent);
    return sum;
  }
  let p = half_slopes(facet, first);
  let q = half_slopes(facet, last);
  let share = select(edge_share(p.xy, q.xy), fan_share(p.xy, q.xy, middle.xy), middle.z > 0.5);
  let lobe = ggx_slopes(p.xy);
  sum.light += light * share;
  sum.value += weight(facet, first, p) * lobe;
  sum.lobe += lobe;
  sum.count += 1.0;
  return sum;
}

fn nearest_to_mirror(facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  let distance = max(length(reach), 1e-9);
  let axis = reach / distance;
  let sine = min(radius / distance, 0.999);
  let cosine = sqrt(1.0 - sine * sine);
  let along = dot(facet.mirror, axis);
  let across = facet.mirror - along * axis;
  let bounded = cosine * axis + sine / max(length(across), 1e-9) * across;
  let closest = select(bounded, facet.mirror, along > cosine);
  let rough = sqrt(facet.alpha.x * facet.alpha.y);
  return normalize(above_horizon(facet, closest + (axis - closest) * rough));
}

fn held_light(held: Held, facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  // Lifted to the horizon, an outline straight below would go all the way round it.
  let risen = select(0.0, 1.0, dot(facet.normal, reach) > -radius);
  if (facet.kind == PHONG) {
    return risen * abs(held.light) * facet.straight;
  }
  let near = nearest_to_mirror(facet, reach, radius);
  let seen = half_slopes(facet, near);
  let lobe = ggx_slopes(seen.xy);
  let own = weight(facet, near, seen) * lobe;
  let count = max(held.count, 1.0);
  return risen * abs(held.light) * (own + held.value / count) / (lobe + held.lobe / count);
}

// A closed outline of `CORNERS` corners of one luminance.
fn outline_highlight(facet: Facet, reach: vec3f, radius: f32, corners: array<vec3f, 16>) -> vec3f {
  let middle = lamp_middle(facet, reach, radius);
  var held = Held(vec3f(0.0), vec3f(0.0), 0.0, 0.0);
  var around = corners;
  for (var i = 0; i < CORNERS; i++) {
    held = with_edge(held, facet, middle, around[i], around[(i + 1) & (CORNERS - 1)], vec3f(1.0));
  }
  return held_light(held, facet, reach, radius);
}

fn ball_highlight(facet: Facet, reach: vec3f, radius: f32) -> vec3f {
  let distance = max(length(reach), 1e-9);
  let towards = reach / distance;
  let sine = min(radius / distance, 0.999);
  let wide = SAME_AREA * sine / sqrt(1.0 - sine * sine);
  let a = first_of_frame(towards);
  let b = second_of_frame(towards);
  var corners: array<vec3f, 16>;
  for (var i = 0; i < CORNERS; i++) {
    let turn = f32(i) * (2.0 * PI / f32(CORNERS));
    corners[i] = towards + wide * (cos(turn) * a + sin(turn) * b);
  }
  return outline_highlight(facet, reach, radius, corners);
}
