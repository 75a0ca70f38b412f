// Sphere and disk.

//!import andon/transport/direct/areas/angles.wgsl

// `reach` = centre − receiver. At or inside the surface: as on it.
fn sphere_factor(reach: vec3f, normal: vec3f, radius: f32) -> f32 {
  let square = dot(reach, reach);
  let inverse = inverseSqrt(max(square, TINY));
  let sin_r = min(radius * inverse, 1.0);
  let gap = square * inverse - radius;
  let cos_r = sqrt(max(gap * (gap + 2.0 * radius), 0.0)) * inverse;
  let c = clamp(dot(reach, normal) * inverse, -1.0, 1.0);
  let s = sqrt((1.0 - c) * (1.0 + c));
  // cos of half the rim's arc above the horizon: −1, and with it the whole, for a high sphere
  let edge = clamp(-cos_r * c / max(sin_r * s, TINY), -1.0, 1.0);
  let y = s * sqrt((1.0 - edge) * (1.0 + edge)) * sin_r;
  // atan2(y, cos_r) − y·cos_r; for small spheres from the excess over z = tan, which is all there is
  let z = y / max(cos_r, TINY);
  let small = z * (atan_excess(z * z) + sin_r * sin_r);
  let segment = select(angle_of(y, cos_r) - y * cos_r, small, z < 1.0);
  return max(fma(sin_r * sin_r * c, angle_of_cosine(edge), segment), 0.0);
}

// Two unit vectors perpendicular to unit z and to one another.
fn disk_axes(z: vec3f) -> mat2x3f {
  let helper = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(z.x) < 0.6);
  let right = normalize(cross(z, helper));
  return mat2x3f(right, cross(z, right));
}

// `reach` = centre − receiver, `direction` the unit normal of the front. 0 behind and in the plane.
fn disk_factor(reach: vec3f, normal: vec3f, direction: vec3f, radius: f32) -> f32 {
  let axes = disk_axes(-direction);
  let away = -dot(reach, direction);
  let z0 = max(away, 0.0);
  let flat_reach = reach * axes;
  let u0 = length(flat_reach);
  let turn = select(vec2f(1.0, 0.0), flat_reach / max(u0, TINY), u0 > TINY);
  let flat_normal = normal * axes;
  let nu = dot(flat_normal, turn);
  let nv = flat_normal.y * turn.x - flat_normal.x * turn.y;
  let nz = -dot(normal, direction);

  // |x|² along the rim is d + e cos t; w² = d² − e², and the anomalies differ by arg(1 + κ e^{it}).
  let near_u = u0 - radius;
  let far_u = u0 + radius;
  let w = sqrt(fma(z0, z0, near_u * near_u)) * sqrt(fma(z0, z0, far_u * far_u));
  let d = fma(u0, u0, fma(z0, z0, radius * radius));
  let e = 2.0 * radius * u0;
  let kappa = e / (d + w);

  // What the whole disk gives, over π, its cancellation taken out.
  let k = fma(radius, radius, (z0 - u0) * (z0 + u0));
  let across = 2.0 * u0 * z0;
  let stable = select(across * across / max(w - k, TINY), k + w, k > 0.0);
  let scale = radius / max(w * (d + w), TINY);
  let per_radian = radius * scale * fma(nz, stable, across * nu);

  // The rim is above the horizon within Δ of ψ, its highest point.
  let steep = sqrt(fma(nu, nu, nv * nv));
  let psi = select(vec2f(1.0, 0.0), vec2f(nu, nv) / max(steep, TINY), steep > TINY);
  let height = fma(u0, nu, z0 * nz);
  let cosine = clamp(-height / max(radius * steep, TINY), -1.0, 1.0);
  let sine = sqrt((1.0 - cosine) * (1.0 + cosine));
  let delta = angle_of_cosine(cosine);

  // The anomalies' part of the arc, and ∫ sin t/|x|².
  let imaginary = 2.0 * sine * fma(kappa, cosine, psi.x);
  let real = 1.0 + kappa * fma(kappa, fma(2.0 * cosine, cosine, -1.0), 2.0 * psi.x * cosine);
  let pull = u0 * nz * fma(u0, u0, (z0 - radius) * (z0 + radius)) - z0 * nu * d;
  let swing = scale * pull * imaginary * angle_over(kappa * imaginary, real);
  let middle = max(fma(e * psi.x, cosine, d), TINY);
  let lean = psi.y * sine / middle;
  let slope = -radius * z0 * nv * lean * atanh_over(e * lean);

  // The chord on the horizon closes it.
  let half_chord = radius * sine;
  let side = u0 * psi.y;
  let near = z0 * steep - fma(radius, cosine, u0 * psi.x) * nz;
  let closure = angle_of(2.0 * half_chord * near, near * near + (side - half_chord) * (side + half_chord));
  let factor = fma(delta, per_radian, swing) + slope + 0.5 * select(0.0, closure, sine > 0.0);
  return select(0.0, clamp(factor, 0.0, PI), away > 0.0);
}
