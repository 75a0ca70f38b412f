// Exact shadows: the four texels around the receiver name the triangles that may stand in the way,
// and each is asked. Edges are those of the triangles, not of texels; what no texel sees (slivers
// below a texel) casts no shadow. Sixteen reads a lamp instead of one.

//!import andon/transport/direct/shadows/blend.wgsl

// Four rows for each triangle and lamp: the plane q (q·(P − lamp) = 1 on it), and the inward
// normals of the three planes through the lamp and an edge.
@group(1) @binding(4) var<storage, read> occluders: array<vec4f>;

// Directions this close to an edge, in rad, are inside both its triangles: no light leaks through.
const EDGE: f32 = 1e-6;

fn stands_between(point: Receiver, reach: vec3f, texel: vec2i) -> bool {
  let layer = max(point.layer, 0) + select(1, 0, point.reach.z >= 0.0);
  let number = i32(textureLoad(paraboloids, texel, layer, 0).x);
  let row = 4 * ((point.layer / 2) * TRIANGLES + max(number, 1) - 1);
  let beyond = dot(occluders[row].xyz, reach) > 1.0 + SAME_DEPTH;
  let direction = normalize(reach);
  let inside = dot(occluders[row + 1].xyz, direction) >= -EDGE
            && dot(occluders[row + 2].xyz, direction) >= -EDGE
            && dot(occluders[row + 3].xyz, direction) >= -EDGE;
  return number > 0 && beyond && inside;
}

fn paraboloid_share(point: Receiver, place: vec2f) -> f32 {
  let corner = texel_corner(place);
  let reach = point.reach + point.normal * (point.away - dot(point.normal, point.reach));
  let dark = stands_between(point, reach, corner)
          || stands_between(point, reach, corner + vec2i(1, 0))
          || stands_between(point, reach, corner + vec2i(0, 1))
          || stands_between(point, reach, corner + vec2i(1, 1));
  return select(1.0, 0.0, dark);
}
