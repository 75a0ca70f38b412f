// Lobes of reflection, and how much of them an outline holds: lobes.py and reference.py.

//!import andon/gpu/pi.wgsl
//!import andon/glare/highlights/finish.wgsl

const HORIZON: f32 = 1e-3;
const FAR: f32 = 6.0;
const BEHIND: f32 = 0.05;

fn cross2(p: vec2f, q: vec2f) -> f32 {
  return p.x * q.y - p.y * q.x;
}

fn ggx_slopes(slopes: vec2f) -> f32 {
  let square = 1.0 + dot(slopes, slopes);
  return 1.0 / (PI * square * square);
}

fn edge_share(p: vec2f, q: vec2f) -> f32 {
  let c = cross2(p, q);
  let way = q - p;
  let delta = sqrt(max(dot(way, way) + c * c, 1e-30));
  return c / (2.0 * PI * delta) * atan2(delta, 1.0 + dot(p, q));
}

fn fan_share(p: vec2f, q: vec2f, middle: vec2f) -> f32 {
  let area = 0.5 * cross2(p - middle, q - middle);
  let inner = ggx_slopes(0.5 * (q + middle)) + ggx_slopes(0.5 * (middle + p));
  return area * (ggx_slopes(0.5 * (p + q)) + inner) / 3.0;
}

fn schlick(cosine: f32, straight: vec3f) -> vec3f {
  let rest = 1.0 - clamp(cosine, 0.0, 1.0);
  let square = rest * rest;
  return straight + (1.0 - straight) * (square * square * rest);
}

fn dielectric(cosine: f32, ratio: f32) -> f32 {
  let square = ratio * ratio - 1.0 + cosine * cosine;
  let g = sqrt(max(square, 0.0));
  let a = (g - cosine) / max(g + cosine, 1e-30);
  let b = (cosine * (g + cosine) - 1.0) / select(1.0, cosine * (g - cosine) + 1.0, square > 0.0);
  return select(0.5 * a * a * (1.0 + b * b), 1.0, square <= 0.0);
}

fn reflectance(facet: Facet, cosine: f32) -> vec3f {
  if (facet.kind == WATER) {
    return vec3f(dielectric(cosine, facet.ratio));
  }
  return schlick(cosine, facet.straight);
}

fn above_horizon(facet: Facet, towards: vec3f) -> vec3f {
  return towards + max(HORIZON * length(towards) - dot(towards, facet.normal), 0.0) * facet.normal;
}

// Of the half vector of `towards`: its slopes in units of α, n·h, and v·h.
fn half_slopes(facet: Facet, towards: vec3f) -> vec4f {
  let half_vector = local(facet, normalize(towards)) + facet.local_view;
  let reach = max(length(half_vector), 1e-9);
  let cosine = clamp(dot(half_vector, facet.local_view) / reach, 0.0, 1.0);
  let slopes = half_vector.xy / max(half_vector.z, 1e-9) / facet.alpha;
  return vec4f(slopes, max(half_vector.z / reach, 1e-6), cosine);
}

fn flatness(facet: Facet, direction: vec3f) -> f32 {
  let leaning = facet.alpha * direction.xy / max(direction.z, 1e-3);
  return dot(leaning, leaning);
}

// F·G₂·(v·h)/((n·v)(n·h)), where `seen` is that of half_slopes.
fn weight(facet: Facet, towards: vec3f, seen: vec4f) -> vec3f {
  let light = flatness(facet, local(facet, normalize(towards)));
  let shown = 2.0 / (sqrt(1.0 + flatness(facet, facet.local_view)) + sqrt(1.0 + light));
  let factor = shown * seen.w / (max(facet.local_view.z, 1e-3) * seen.z);
  return reflectance(facet, seen.w) * factor;
}

// 1/sr: luminance per lux on a plane that faces a small lamp.
fn mirrored(facet: Facet, direction: vec3f) -> vec3f {
  let lit = dot(facet.normal, direction) > 0.0;
  if (facet.kind == PHONG) {
    let cosine = max(dot(facet.mirror, direction), 0.0);
    let lobe = (facet.exponent + 1.0) / (2.0 * PI) * pow(cosine, facet.exponent);
    return select(vec3f(0.0), lobe * facet.straight, lit);
  }
  let towards = above_horizon(facet, direction);
  let seen = half_slopes(facet, towards);
  let density = ggx_slopes(seen.xy) / (facet.alpha.x * facet.alpha.y);
  let lobe = weight(facet, towards, seen) * density / (4.0 * max(seen.w, 1e-6) * seen.z * seen.z * seen.z);
  return select(vec3f(0.0), lobe, lit);
}

fn phong_plane(facet: Facet, towards: vec3f) -> vec2f {
  let a = first_of_frame(facet.mirror);
  let b = second_of_frame(facet.mirror);
  let height = max(dot(towards, facet.mirror), BEHIND * length(towards));
  return vec2f(dot(towards, a), dot(towards, b)) / max(height, 1e-30);
}

fn phong_edge_share(p: vec2f, q: vec2f, exponent: f32) -> f32 {
  let reach = max(length(q - p), 1e-12);
  let way = (q - p) / reach;
  let beside = cross2(p, way);
  let start = dot(p, way);
  let width = sqrt(beside * beside + 2.0 / (exponent + 1.0));
  let ends = atan(vec2f(start, start + reach) / width);
  let nodes = vec4f(-0.8611363, -0.3399810, 0.3399810, 0.8611363);
  let along = width * tan(0.5 * (ends.x + ends.y) + nodes * (0.5 * (ends.y - ends.x)));
  let square = max(beside * beside + along * along, vec4f(1e-12));
  let within = 1.0 - pow(1.0 + square, vec4f(-0.5 * (exponent + 1.0)));
  let each = within / square * (width * width + along * along) / width;
  let gauss = vec4f(0.3478548, 0.6521452, 0.6521452, 0.3478548);
  return dot(gauss, each) * beside * (ends.y - ends.x) / (4.0 * PI);
}
