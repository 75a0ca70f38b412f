// Polygons, luminous pictures and meshes: plain sums over edges, with no list of vertices and no
// case for a cut outline.

//!import andon/transport/direct/areas/angles.wgsl

struct EdgePart {
  arc: f32,      // ½ of Lambert's term, above the horizon
  sign: f32,     // 1 where the edge leaves, −1 where it enters, 0 where it does not cross
  azimuth: f32,  // of the crossing from `towards`, −π…π
};

// `a`, `b`: vertices − receiver. `towards`: any vector that is not parallel to the normal.
fn edge_part(a: vec3f, b: vec3f, normal: vec3f, towards: vec3f) -> EdgePart {
  let edge = b - a;
  let height_a = dot(a, normal);
  let height_b = dot(b, normal);
  let above_a = height_a > 0.0;
  let above_b = height_b > 0.0;
  let drop = height_a - height_b;
  let at = clamp(height_a / select(1.0, drop, abs(drop) > TINY), 0.0, 1.0);
  let start = select(at, 0.0, above_a);
  let end = select(at, 1.0, above_b);
  let share = select(0.0, end - start, above_a || above_b);
  let first = fma(vec3f(start), edge, a);
  let last = fma(vec3f(end), edge, a);

  // θ/|first × last|: 1/sin of what lies beyond a right angle, and a polynomial in the cosine
  let area = cross(edge, a);
  let inverse = inverseSqrt(max(dot(first, first) * dot(last, last), TINY));
  let cosine = clamp(dot(first, last) * inverse, -1.0, 1.0);
  let near = acos_over_root(abs(cosine)) * inverseSqrt(1.0 + abs(cosine)) * inverse;
  let beyond = PI * inverseSqrt(max(share * share * dot(area, area), TINY)) - near;
  let angle = select(near, beyond, cosine < 0.0);
  let arc = 0.5 * share * dot(area, normal) * angle;

  // Relative to `towards`, so that what is small stays exact.
  let aside = cross(normal, towards);
  let ahead = cross(aside, normal);
  let y = fma(at, dot(aside, edge), dot(aside, a - towards));
  let x = dot(ahead, fma(vec3f(at), edge, a));
  return EdgePart(arc, f32(above_a) - f32(above_b), angle_of(y, x));
}

// The share of an edge in the factor of a flat lamp: the sum over the edges of a polygon that runs
// counter-clockwise as seen from the receiver is its factor, over a clockwise one the negative.
fn edge_factor(a: vec3f, b: vec3f, normal: vec3f, towards: vec3f) -> f32 {
  let part = edge_part(a, b, normal, towards);
  return fma(0.5 * part.sign, part.azimuth, part.arc);
}

// `towards` for the edges of a flat lamp: `centre` (− receiver) of a ball of radius `bound` that
// holds it, `plane` the unit normal of its front. To the centre where all of the lamp that meets
// the horizon lies less than 90° from there, else to the lamp's plane, never opposite to any of it.
fn polygon_towards(centre: vec3f, bound: f32, plane: vec3f, normal: vec3f) -> vec3f {
  let aside = cross(normal, centre);
  let foot = plane * select(-1.0, 1.0, dot(plane, centre) > 0.0);
  return select(foot, centre, dot(aside, aside) > bound * bound);
}

// `towards` for the edges of a mesh: to any point of it (− receiver), unless that is overhead.
fn mesh_towards(centre: vec3f, normal: vec3f) -> vec3f {
  let aside = cross(normal, centre);
  let helper = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(normal.x) < 0.6);
  return select(helper, centre, dot(aside, aside) > 1e-4 * dot(centre, centre));
}

// Azimuths of one facet must not jump within it. A facet whose plane lies on the side of `towards`
// cannot meet the direction opposite to it, where −π…π jumps; any other cannot meet `towards`,
// where 0…2π does. `outward.xyz` is the facet's unit normal.
fn facet_share(part: EdgePart, outward: vec4f, towards: vec3f, normal: vec3f) -> f32 {
  let ahead = dot(outward.xyz, towards) - dot(outward.xyz, normal) * dot(towards, normal);
  let azimuth = part.azimuth + select(0.0, 2.0 * PI, ahead > 0.0 && part.azimuth < 0.0);
  return select(0.0, fma(0.5 * part.sign, azimuth, part.arc), outward.w > 0.0);
}

// The shares of an edge in the factors of the facet on its left (x) and, to be subtracted, of the
// one on its right (y). Planes: xyz outward unit normal, w the receiver's height above the plane.
// Right for every mesh, receiver and `towards` (`mesh_towards`): no facet depends on another.
fn facet_edge_factor(a: vec3f, b: vec3f, left: vec4f, right: vec4f, normal: vec3f, towards: vec3f) -> vec2f {
  let part = edge_part(a, b, normal, towards);
  return vec2f(facet_share(part, left, towards, normal), facet_share(part, right, towards, normal));
}
