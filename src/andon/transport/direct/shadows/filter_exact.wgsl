// Exact shadows: the four texels around the receiver name the triangles that may stand in the way,
// and each is asked. Edges are those of the triangles, not of texels; what no texel sees (slivers
// below a texel) casts no shadow of its own. Sixteen reads a lamp instead of one.

//!import andon/transport/direct/shadows/blend.wgsl

// Four rows for each triangle and lamp: the plane q (q·(P − lamp) = 1 on it), and the inward
// normals of the three planes through the lamp and an edge.
@group(1) @binding(4) var<storage, read> occluders: array<vec4f>;

// Triangles are asked at the receiver's own place: no texel lies between it and them.
const PARABOLOID_LIFT_TEXELS: f32 = 0.0;

// Directions this close to an edge, in rad, are inside both its triangles: no light leaks through.
const EDGE: f32 = 1e-6;

// A receiver this much farther than all four triangles' planes stands in the middle of a shadow,
// whichever sliver between them is in the way. Facets of one body bend away by less in a texel.
const WELL_BEYOND: f32 = 1.003;

// x: the triangle of this texel stands between; y: the receiver is well beyond its plane.
fn asked(point: Receiver, reach: vec3f, direction: vec3f, texel: vec2i) -> vec2<bool> {
  let layer = max(point.layer, 0) + select(1, 0, point.reach.z >= 0.0);
  let number = i32(textureLoad(paraboloids, texel, layer, 0).x);
  let row = 4 * ((point.layer / 2) * TRIANGLES + max(number, 1) - 1);
  let ratio = dot(occluders[row].xyz, reach);
  let inside = dot(occluders[row + 1].xyz, direction) >= -EDGE
            && dot(occluders[row + 2].xyz, direction) >= -EDGE
            && dot(occluders[row + 3].xyz, direction) >= -EDGE;
  let there = number > 0;
  return vec2<bool>(there && inside && ratio > 1.0 + SAME_DEPTH, there && ratio > WELL_BEYOND);
}

fn paraboloid_share(point: Receiver, place: vec2f) -> f32 {
  let corner = texel_corner(place);
  let reach = point.reach + point.normal * (point.away - dot(point.normal, point.reach));
  let direction = normalize(reach);
  let a = asked(point, reach, direction, corner);
  let b = asked(point, reach, direction, corner + vec2i(1, 0));
  let c = asked(point, reach, direction, corner + vec2i(0, 1));
  let d = asked(point, reach, direction, corner + vec2i(1, 1));
  let dark = a.x || b.x || c.x || d.x || (a.y && b.y && c.y && d.y);
  return select(1.0, 0.0, dark);
}
