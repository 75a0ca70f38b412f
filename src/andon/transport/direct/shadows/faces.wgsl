// Triangles into six plane faces around a lamp, each 90° wide, laid out 3 × 2 in one picture:
// face 2·axis + (0 towards +, 1 towards −); its image axes are the next two world axes.

//!struct FaceRecord

@group(0) @binding(0) var<uniform> lamp: FaceRecord;

@vertex fn face_corner(
  @location(0) position: vec3f, @builtin(instance_index) face: u32,
) -> @builtin(position) vec4f {
  let p = position - lamp.position;
  let axis = face >> 1u;
  var q = p.yzx;  // image x, image y, along
  if (axis == 1u) { q = p.zxy; }
  if (axis == 2u) { q = p; }
  // Reversed infinite depth near/z is linear in the picture and keeps float32's precision.
  return vec4f(q.x, -q.y, lamp.near_m, select(q.z, -q.z, (face & 1u) == 1u));
}

// Slope of the depth per texel, relative to it: with the depth it gives the triangle's plane
// anywhere within the texel.
@fragment fn face_slope(@builtin(position) p: vec4f) -> @location(0) vec2f {
  return vec2f(dpdx(p.z), dpdy(p.z)) / p.z;
}
