// Baked light between two moments; where only one of them knows the point, since something moved,
// that one (illuminance_at in reference.py).

//!import andon/transport/baked/moments.wgsl

// Illuminance in lux (xyz), and 1 where it is known (w).
fn projected_lux(position: vec3f, normal: vec3f) -> vec4f {
  let earlier = baked_earlier(position, normal);
  let later = baked_later(position, normal);
  let share = select(select(1.0, baked.later_share, earlier.w > 0.0), 0.0, later.w == 0.0);
  let lux = (1.0 - share) * baked.earlier_scale * earlier.xyz + share * baked.later_scale * later.xyz;
  return vec4f(lux, max(earlier.w, later.w));
}
