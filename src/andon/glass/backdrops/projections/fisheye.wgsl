// Equidistant: (x, y)·θ/r with r = |(x, y)|, θ = atan2(r, z). See pinhole.wgsl.

const WIDTH_REPEATS: bool = false;
const IS_PLANAR: bool = false;

fn pixel_of(p: vec3f) -> vec2f {
  let planar = length(p.xy);
  let scale = select(1.0 / p.z, atan2(planar, p.z) / max(planar, 1e-20), planar > 1e-6 * abs(p.z));
  return p.xy * scale * view.focal + view.centre;
}

fn is_seen(p: vec3f) -> bool {
  return length(p.xy) > 0.0 || p.z > 0.0;
}

fn depth_of(p: vec3f) -> f32 {
  return length(p);
}

fn moved_pixel(p: vec3f, shift: vec3f) -> vec2f {
  let planar = length(p.xy);
  let away = planar > 1e-3 * abs(p.z);
  let r = select(1.0, planar, away);
  let scale = select(1.0 / p.z, atan2(planar, p.z) / r, away);
  let radial = dot(p.xy, shift.xy) / r;
  let turned = (p.z * radial - planar * shift.z) / dot(p, p);
  let growth = select(-shift.z / (p.z * p.z), (turned - scale * radial) / r, away);
  return (shift.xy * scale + p.xy * growth) * view.focal;
}
