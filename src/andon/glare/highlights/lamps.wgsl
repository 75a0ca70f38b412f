// What a facet mirrors of each kind of lamp, and of wide light: reference.py.

//!import andon/glare/highlights/areas.wgsl
//!import andon/glare/highlights/albedo.wgsl
//!import andon/glare/highlights/sum.wgsl

// From the lux on the surface to that on a plane that faces the lamp.
fn facing_lux(facet: Facet, towards: vec3f, lux: vec3f) -> vec3f {
  let cosine = dot(facet.ground, towards);
  return select(vec3f(0.0), lux / max(cosine, 1e-4), cosine > 1e-4);
}

// `lux` is that on the surface; `radius` that of the ball that the lamp is drawn as, or 0.
fn place_highlight(facet: Facet, lamp: i32, lux: vec3f, radius: f32) -> vec3f {
  let reach = lamps[lamp].position - facet.position;
  let square = max(dot(reach, reach), 1e-6);
  let towards = reach * inverseSqrt(square);
  let facing = facing_lux(facet, towards, lux);
  if (radius <= 0.0) {
    return facing * mirrored(facet, towards);
  }
  return facing * (square / (PI * radius * radius)) * ball_highlight(facet, reach, radius);
}

fn distant_highlight(facet: Facet, lamp: i32, lux: vec3f) -> vec3f {
  let towards = -lamps[lamp].axis;
  return facing_lux(facet, towards, lux) * mirrored(facet, towards);
}

fn sphere_highlight(facet: Facet, lamp: i32) -> vec3f {
  let record = lamps[lamp];
  return record.light * ball_highlight(facet, record.position - facet.position, record.radius_m);
}

// Luminance of a sky or hemisphere about the mirrored view.
fn sky_light(facet: Facet, lamp: i32) -> vec3f {
  let width = max(max(facet.alpha.x, facet.alpha.y), 1e-3);
  let up = clamp(0.5 + 0.5 * dot(facet.mirror, lamps[lamp].axis) / width, 0.0, 1.0);
  return mix(lamps[lamp].right, lamps[lamp].light, up) * (1.0 / PI);
}

fn even_reflectance(facet: Facet, straight: vec3f) -> vec3f {
  let cosine = max(facet.local_view.z, 1e-3);
  if (facet.kind == PHONG) {
    return straight;
  }
  if (facet.kind == WATER) {
    return vec3f(dielectric(cosine, facet.ratio));
  }
  return albedo(cosine, sqrt(0.5 * dot(facet.alpha, facet.alpha)), straight);
}

fn diffuse_share(facet: Facet) -> f32 {
  if (facet.kind == PHONG) {
    let most = max(facet.straight.x, max(facet.straight.y, facet.straight.z));
    return (1.0 - facet.metallic) * (1.0 - most);
  }
  if (facet.kind == WATER) {
    return 1.0 - even_reflectance(facet, facet.straight).x;
  }
  let plain = even_reflectance(facet, vec3f(DIELECTRIC * (1.0 - facet.metallic))).x;
  return (1.0 - facet.metallic) * (1.0 - plain);
}
