// Where a ray meets a closed mesh: its boxes in the order of bvh.py, without a stack. The shader
// that imports this declares the textures `nodes` and `triangles`.

//!import andon/glass/hit.wgsl

// Numbers of bvh.py.
const NODES_A_ROW: i32 = 1024;
const TRIANGLES_A_ROW: i32 = 256;

fn node_texel(node: i32, part: i32) -> vec4f {
  return textureLoad(nodes, vec2i(2 * (node % NODES_A_ROW) + part, node / NODES_A_ROW), 0);
}

fn triangle_texel(triangle: i32, part: i32) -> vec4f {
  return textureLoad(triangles, vec2i(6 * (triangle % TRIANGLES_A_ROW) + part, triangle / TRIANGLES_A_ROW), 0);
}

// The three corners, x, y, z and texture coordinate u or normals and v (`part` 3).
struct Corners {
  a: vec4f,
  b: vec4f,
  c: vec4f,
};

fn corners_of(triangle: i32, part: i32) -> Corners {
  return Corners(
    triangle_texel(triangle, part), triangle_texel(triangle, part + 1), triangle_texel(triangle, part + 2),
  );
}

// Distance to a triangle that is crossed outwards, or inwards; the edge tests of two triangles that
// share an edge are each other's negatives, so none slips between them.
fn triangle_distance(origin: vec3f, direction: vec3f, triangle: i32, inside: bool) -> f32 {
  let k = corners_of(triangle, 0);
  let a = k.a.xyz - origin;
  let b = k.b.xyz - origin;
  let c = k.c.xyz - origin;
  let sides = vec3f(dot(direction, cross(c, b)), dot(direction, cross(a, c)), dot(direction, cross(b, a)));
  let facing = select(sides, -sides, inside);
  let normal = cross(k.b.xyz - k.a.xyz, k.c.xyz - k.a.xyz);
  let distance = dot(a, normal) / dot(direction, normal);
  let met = all(facing >= vec3f(0.0)) && facing.x + facing.y + facing.z > 0.0 && distance > -NEAR;
  return select(NOWHERE, max(distance, 0.0), met);
}

// How the corners' weights grow along a triangle, per metre.
struct Slopes {
  facet: vec3f,
  a: vec3f,
  b: vec3f,
  c: vec3f,
};

fn slopes_of(k: Corners) -> Slopes {
  let normal = cross(k.b.xyz - k.a.xyz, k.c.xyz - k.a.xyz);
  let square = max(dot(normal, normal), 1e-38);
  let facet = normal * inverseSqrt(square);
  let across = normal / square;
  return Slopes(
    facet, cross(across, k.c.xyz - k.b.xyz), cross(across, k.a.xyz - k.c.xyz),
    cross(across, k.b.xyz - k.a.xyz),
  );
}

// Interpolated normal, and how it turns.
fn mesh_surface(distance: f32, point: vec3f, triangle: i32, number: i32) -> Hit {
  let k = corners_of(triangle, 0);
  let s = slopes_of(k);
  let n = corners_of(triangle, 3);
  let weight_b = dot(point - k.a.xyz, s.b);
  let weight_c = dot(point - k.a.xyz, s.c);
  let mixed = n.a.xyz + weight_b * (n.b.xyz - n.a.xyz) + weight_c * (n.c.xyz - n.a.xyz);
  let scale = inverseSqrt(max(dot(mixed, mixed), 1e-30)) * select(-1.0, 1.0, dot(mixed, s.facet) >= 0.0);
  let normal = mixed * scale;
  let matrix = mat3x3f(n.a.xyz, n.b.xyz, n.c.xyz) * transpose(mat3x3f(s.a, s.b, s.c)) * scale;
  let along = normal * matrix;
  let turning = matrix - mat3x3f(normal * along.x, normal * along.y, normal * along.z);
  return Hit(distance, normal, s.facet, turning, number);
}

fn mesh_hit(origin: vec3f, direction: vec3f, solid: SolidRecord, inside: bool) -> Hit {
  // A component that is 0 would give 0·∞ in the plane of a box: a hair beside it gives ±∞.
  let inverse = 1.0 / select(direction, vec3f(1e-20), abs(direction) < vec3f(1e-20));
  let falls = select(vec3i(0), vec3i(1, 2, 4), direction < vec3f(0.0));
  let count = i32(solid.size.x);
  let first = solid.first_node + count * (falls.x + falls.y + falls.z);
  var nearest = NOWHERE;
  var chosen = -1;
  var node = 0;
  while node < count {
    // On to the next leaf; the triangles wait until every ray of a group has one.
    var leaf = -1;
    while node < count && leaf < 0 {
      let low = node_texel(first + node, 0);
      let high = node_texel(first + node, 1);
      let t0 = (low.xyz - origin) * inverse;
      let t1 = (high.xyz - origin) * inverse;
      let near = min(t0, t1);
      let far = max(t0, t1);
      let enter = max(near.x, max(near.y, near.z));
      let leave = min(far.x, min(far.y, far.z));
      let met = leave >= max(enter, 0.0) && enter <= nearest;
      leaf = select(-1, i32(high.w), met);
      node = select(i32(low.w), node + 1, met);
    }
    let start = leaf / 8;
    for (var k = start; k < start + select(0, leaf % 8, leaf >= 0); k++) {
      let distance = triangle_distance(origin, direction, solid.first_triangle + k, inside);
      chosen = select(chosen, k, distance < nearest);
      nearest = min(nearest, distance);
    }
  }
  let at = solid.first_triangle + max(chosen, 0);
  return mesh_surface(nearest, origin + direction * min(nearest, 1e6), at, chosen);
}

// Its own texture coordinates; pictures repeat.
fn mesh_sticking(point: vec3f, triangle: i32, moves: mat2x3f) -> Sticking {
  let k = corners_of(triangle, 0);
  let n = corners_of(triangle, 3);
  let s = slopes_of(k);
  let corners = mat3x2f(vec2f(k.a.w, n.a.w), vec2f(k.b.w, n.b.w), vec2f(k.c.w, n.c.w));
  let along_b = dot(point - k.a.xyz, s.b);
  let along_c = dot(point - k.a.xyz, s.c);
  let slopes = mat3x3f(s.a, s.b, s.c);
  let steps = mat2x2f(corners * (moves[0] * slopes), corners * (moves[1] * slopes));
  return Sticking(fract(corners * vec3f(1.0 - along_b - along_c, along_b, along_c)), steps);
}
