// The closest point of the hull (lookup_facets.py): from facet to facet among those that share a
// corner, while one has a nearer point. The closest point of a facet is found here by its plane or
// its three edges, whichever is nearest: clear, and safe for facets without an area.

//!import andon/transport/probes/cells.wgsl

struct OnFacet {
  weights: vec3f,
  away: vec3f,
  in_front: bool,
};

// Closest points nearer to each other than this share of the zone, or of the distance, are one.
const PROBE_SAME_POINT: f32 = 1e-6;
const PROBE_VISIBLE: f32 = -1e-5;

// Share of the way from the first to the second end of an edge; `to` from the first to the point.
fn along_edge(edge: vec3f, to: vec3f) -> f32 {
  return clamp(dot(edge, to) / max(dot(edge, edge), 1e-30), 0.0, 1.0);
}

fn nearer(a: OnFacet, b: OnFacet) -> OnFacet {
  if (dot(b.away, b.away) < dot(a.away, a.away)) { return b; }
  return a;
}

fn on_facet(facet: i32, position: vec3f) -> OnFacet {
  let base = PROBE_FACETS + 4 * facet;
  let a = datum(base).xyz;
  let b = datum(base + 1).xyz;
  let c = datum(base + 2).xyz;
  let settings = datum(base + 3);
  let ab = b - a;
  let ac = c - a;
  let to = position - a;
  let normal = cross(ab, ac);
  let square = dot(normal, normal);
  let height = dot(to, normal) * inverseSqrt(max(square, 1e-30));
  let front = settings.z < 0.0 || height >= PROBE_VISIBLE * (length(to) + settings.w);
  let wb = dot(cross(to, ac), normal) / max(square, 1e-30);
  let wc = dot(cross(ab, to), normal) / max(square, 1e-30);
  if (square > 1e-30 && min(min(wb, wc), 1.0 - wb - wc) >= 0.0) {
    let plain = vec3f(1.0 - wb - wc, wb, wc);
    return OnFacet(plain, to - wb * ab - wc * ac, front);
  }
  let t = along_edge(ab, to);
  let u = along_edge(ac, to);
  let v = along_edge(c - b, position - b);
  let first = OnFacet(vec3f(1.0 - t, t, 0.0), to - t * ab, front);
  let second = OnFacet(vec3f(1.0 - u, 0.0, u), to - u * ac, front);
  let third = OnFacet(vec3f(0.0, 1.0 - v, v), position - b - v * (c - b), front);
  return nearer(nearer(first, second), third);
}

fn hull_mix(position: vec3f, start: i32) -> ProbeMix {
  var facet = start;
  var best = on_facet(facet, position);
  var done = best.in_front && min(best.weights.x, min(best.weights.y, best.weights.z)) > 0.0;
  for (var step = 0; step < PROBE_FACET_STEPS; step++) {
    if (done) { break; }
    let settings = datum(PROBE_FACETS + 4 * facet + 3);
    let last = i32(settings.x) + i32(settings.y);
    let same = PROBE_SAME_POINT * (settings.w + length(best.away));
    var most = 0.0;
    var next = facet;
    var ahead = best;
    for (var k = i32(settings.x); k < last; k++) {
      let other = listed(PROBE_RINGS, k);
      let there = on_facet(other, position);
      let moved = best.away - there.away;
      let gain = dot(moved, best.away + there.away);
      if (there.in_front && gain > most && dot(moved, moved) > same * same) {
        most = gain;
        next = other;
        ahead = there;
      }
    }
    done = next == facet;
    facet = next;
    best = ahead;
  }
  let base = PROBE_FACETS + 4 * facet;
  let probes = vec3i(vec3f(datum(base).w, datum(base + 1).w, datum(base + 2).w));
  return ProbeMix(probes.xyzx, vec4f(best.weights, 0.0));
}

// The probes around a point and their weights, ≥ 0, sum 1.
fn locate(position: vec3f) -> ProbeMix {
  let start = walk_start(position, zone_of(position));
  let walked = walk_cells(position, start);
  // One call: a software rasteriser pays for each that stands in the code.
  if (walked.exit >= 0) { return hull_mix(position, walked.exit); }
  let weights = max(walked.weights, vec4f(0.0));
  let probes = vec4i(datum(PROBE_CELLS + 5 * walked.cell + 4));
  return ProbeMix(probes, weights / (weights.x + weights.y + weights.z + weights.w));
}
