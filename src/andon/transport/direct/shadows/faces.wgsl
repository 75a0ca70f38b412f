// Triangles into six plane faces around a lamp, each 90° wide, laid out 3 × 2 in one picture:
// face 2·axis + (0 towards +, 1 towards −); its image axes are the next two world axes.
//
// What is drawn is the *plane* of the triangle that is seen, not how far it is: a rasteriser snaps
// corners to 1/256 pixel, so its depths are off by 1e-4 and more on slanted triangles, and a plane
// holds anywhere within the texel. q·(P − lamp) = 1 for the points P of the plane, so that along a
// unit direction d it is 1/(q·d) away; q = 0 is "nothing there".

//!struct FaceRecord

@group(0) @binding(0) var<uniform> lamp: FaceRecord;
// Corners of all triangles, three floats each.
@group(0) @binding(1) var<storage, read> positions: array<f32>;
// Corner numbers, three for each triangle that a face sees, face after face.
@group(0) @binding(2) var<storage, read> corners: array<u32>;

// q of each of those triangles.
@group(0) @binding(3) var<storage, read> planes: array<vec4f>;

struct Seen {
  @builtin(position) clip: vec4f,
  @location(0) @interpolate(flat, first) plane: vec4f,
};

@vertex fn face_corner(
  @builtin(vertex_index) index: u32, @builtin(instance_index) face: u32,
) -> Seen {
  let at = 3u * corners[index];
  let p = vec3f(positions[at], positions[at + 1u], positions[at + 2u]) - lamp.position;
  let axis = face >> 1u;
  var q = p.yzx;  // image x, image y, along
  if (axis == 1u) { q = p.zxy; }
  if (axis == 2u) { q = p; }
  // Reversed infinite depth near/z is linear in the picture and keeps float32's precision.
  let along = select(q.z, -q.z, (face & 1u) == 1u);
  return Seen(vec4f(q.x, -q.y, lamp.near_m, along), planes[index / 3u]);
}

@fragment fn face_plane(seen: Seen) -> @location(0) vec4f {
  return seen.plane;
}
