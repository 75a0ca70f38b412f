// Pencils: how a ray moves when its start does (ray differentials, Igehy 1999). Columns: the origin
// moved by e1, by e2, metre per metre; the direction moved by e1, by e2, per radian.

//!import andon/glass/curvature.wgsl

struct Pencil {
  place: mat4x3f,
  course: mat4x3f,
};

// Of a view ray, where it starts: e1, e2 and `direction` are orthonormal.
fn start_pencil(e1: vec3f, e2: vec3f) -> Pencil {
  let none = vec3f(0.0);
  return Pencil(mat4x3f(e1, e2, none, none), mat4x3f(none, none, e1, e2));
}

fn outer(a: vec3f, b: vec4f) -> mat4x3f {
  return mat4x3f(a * b.x, a * b.y, a * b.z, a * b.w);
}

// `distance` metres on along D, to a surface with the normal N (Igehy 1999, eq. 10, 11).
fn transferred(p: Pencil, distance: f32, D: vec3f, N: vec3f) -> Pencil {
  let moved = p.place + p.course * distance;
  return Pencil(moved + outer(D, N * moved * (-1.0 / dot(D, N))), p.course);
}

// Through a boundary; N against D, C is N's own (Igehy 1999, eq. 16).
fn refracted_pencil(p: Pencil, D: vec3f, N: vec3f, C: Curvature, ratio: f32, cos_in: f32, cos_out: f32) -> Pencil {
  let dN = C * p.place;
  let d_in = -(N * p.course + D * dN);
  let d_out = ratio * ratio * (cos_in / cos_out) * d_in;
  let course = ratio * p.course + (ratio * cos_in - cos_out) * dN + outer(N, ratio * d_in - d_out);
  return Pencil(p.place, course);
}

// Mirrored by a boundary (Igehy 1999, eq. 14).
fn mirrored_pencil(p: Pencil, D: vec3f, N: vec3f, C: Curvature) -> Pencil {
  let dN = C * p.place;
  let along = N * p.course + D * dN;
  return Pencil(p.place, p.course - 2.0 * dot(D, N) * dN - outer(N, 2.0 * along));
}

// Two unit vectors across the unit vector d (Duff et al. 2017).
struct Frame {
  e1: vec3f,
  e2: vec3f,
};

fn frame_of(d: vec3f) -> Frame {
  let s = select(-1.0, 1.0, d.z >= 0.0);
  let a = -1.0 / (s + d.z);
  let b = d.x * d.y * a;
  return Frame(vec3f(1.0 + s * d.x * d.x * a, s * b, -s * d.x), vec3f(b, s + d.y * d.y * a, -d.y));
}

// Where the point seen at `distance` along D moves: rows (f1, f2) across D, columns as the pencil's.
struct Spread {
  f1: vec4f,
  f2: vec4f,
};

fn spread_at(p: Pencil, D: vec3f, distance: f32) -> Spread {
  let moved = p.place + p.course * distance;
  let f = frame_of(D);
  return Spread(f.e1 * moved, f.e2 * moved);
}

// Vergence of an image at the eye, dioptres: V = B_θ⁻¹·B_x, rows (V11, V12, V21, V22).
fn vergence(s: Spread) -> vec4f {
  let det = s.f1.z * s.f2.w - s.f1.w * s.f2.z;
  // Where rays from one point of the eye meet on the background, its image is at the eye.
  let least = 1.2e-7 * max(dot(s.f1.zw, s.f1.zw) + dot(s.f2.zw, s.f2.zw), 1e-30);
  let size = select(-1.0, 1.0, det >= 0.0) * max(abs(det), least);
  let first = s.f2.w * s.f1.xy - s.f1.w * s.f2.xy;
  let second = s.f1.z * s.f2.xy - s.f2.z * s.f1.xy;
  return vec4f(first, second) / size;
}

// Diameter in radians of the disc that has the second moment of the blur's ellipse A·(V − F·1).
fn blur_radians(V: vec4f, focus_dioptres: f32, pupil_m: f32) -> f32 {
  let left = V - focus_dioptres * vec4f(1.0, 0.0, 0.0, 1.0);
  return pupil_m * sqrt(0.5 * dot(left, left));
}
