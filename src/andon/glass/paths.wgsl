// The path of one ray of the view through all solids: nested dielectrics. A mask says which solids
// the ray is inside of; it travels in the last of them, and a boundary between equal media is none.

//!import andon/glass/refraction.wgsl
//!import andon/glass/pencils.wgsl
//!import andon/glass/solids.wgsl

const GOING: u32 = 0u;
const THROUGH: u32 = 1u;
// Still inside after EVENTS boundaries.
const LOST: u32 = 2u;

// Where a ray is between two boundaries.
struct Travel {
  ray: Ray,
  pencil: Pencil,
  inside: u32,
  transmitted: f32,
  // Σ absorption·length.
  extinction: vec3f,
  status: u32,
};

struct Path {
  // The first solid, −1 for none; where it is met, and how it mirrors.
  solid: i32,
  distance: f32,
  point: vec3f,
  normal: vec3f,
  facet: vec3f,
  curvature: Curvature,
  reflectance: f32,
  // Where the last boundary was left.
  exit: Ray,
  pencil: Pencil,
  // Π(1 − F), and exp(−Σ absorption·length).
  transmitted: f32,
  inside: vec3f,
  status: u32,
};

// The row of a solid in tables; of one alone it is a constant, and what is read there is read once
// for all pixels.
fn row_of(solid: i32) -> i32 {
  return select(max(solid, 0), 0, SOLIDS == 1);
}

// Refractive index of what a ray is in; air is 1.
fn index_of(inside: u32, channel: i32) -> f32 {
  let last = i32(firstLeadingBit(inside));
  return select(solids[row_of(last)].index[channel], 1.0, inside == 0u);
}

fn absorption_of(inside: u32) -> vec3f {
  let last = i32(firstLeadingBit(inside));
  return select(solids[row_of(last)].absorption_per_m, vec3f(0.0), inside == 0u);
}

fn against(D: vec3f, normal: vec3f) -> vec3f {
  return select(normal, -normal, dot(D, normal) > 0.0);
}

// Across one boundary, or back from it.
fn crossed(t: Travel, met: Boundary, channel: i32) -> Travel {
  var on = t;
  let D = t.ray.direction;
  on.ray.origin = t.ray.origin + met.distance * D;
  on.extinction = t.extinction + met.distance * absorption_of(t.inside);
  on.pencil = transferred(t.pencil, met.distance, D, met.facet);
  let beyond = t.inside ^ met.crossed;
  let n1 = index_of(t.inside, channel);
  let n2 = index_of(beyond, channel);
  if SOLIDS > 1 && n1 == n2 {
    on.inside = beyond;
    return on;
  }
  let ratio = n1 / n2;
  var N = against(D, met.normal);
  var C = met.curvature * select(1.0, -1.0, dot(D, met.normal) > 0.0);
  var bend = refracted(D, N, ratio);
  if FACETS && (dot(bend.direction, met.facet) * dot(D, met.facet) > 0.0) == bend.total {
    N = against(D, met.facet);
    C = FLAT;
    bend = refracted(D, N, ratio);
  }
  on.ray.direction = bend.direction;
  if MIRRORS && bend.total {
    on.pencil = mirrored_pencil(on.pencil, D, N, C);
    return on;
  }
  on.pencil = refracted_pencil(on.pencil, D, N, C, ratio, bend.cos_in, bend.cos_out);
  on.transmitted = t.transmitted * (1.0 - fresnel(bend.cos_in, bend.cos_out, ratio));
  on.inside = beyond;
  return on;
}

// `first`: the boundary that the ray meets first, of a solid that it is outside of.
fn trace(ray: Ray, start: Pencil, first: Boundary, channel: i32) -> Path {
  var t = crossed(Travel(ray, start, 0u, 1.0, vec3f(0.0), GOING), first, channel);
  let reflectance = 1.0 - t.transmitted;
  let point = t.ray.origin;
  if ENTRY_ONLY || (SOLIDS > 1 && solids[first.solid].interfaces == 1u) {
    t.status = THROUGH;
  }
  for (var event = 1; event < EVENTS; event++) {
    if t.status == GOING {
      let met = boundary(t.ray, t.inside);
      if met.solid < 0 {
        t.status = select(LOST, THROUGH, t.inside == 0u);
      } else {
        t = crossed(t, met, channel);
        if CONVEX_ALONE && t.inside == 0u {
          t.status = THROUGH;
        }
      }
    }
  }
  if t.status == GOING {
    t.status = select(LOST, THROUGH, t.inside == 0u);
  }
  return Path(
    first.solid, first.distance, point, first.normal, first.facet, first.curvature, reflectance,
    t.ray, t.pencil, select(t.transmitted, 0.0, t.status == LOST), exp(-t.extinction), t.status,
  );
}

// What the first boundary mirrors: the ray that leaves it, and its pencil.
fn mirror(ray: Ray, start: Pencil, path: Path) -> Travel {
  let at = transferred(start, path.distance, ray.direction, path.facet);
  let away = Ray(path.point, mirrored(ray.direction, path.normal));
  let pencil = mirrored_pencil(at, ray.direction, path.normal, path.curvature);
  return Travel(away, pencil, 0u, path.reflectance, vec3f(0.0), THROUGH);
}
