// Soft shadows: the mean of what points on an area lamp see (soft.py).

//!struct SampleRecord

// Paraboloid pairs around the samples of all area lamps, and the samples.
@group(1) @binding(5) var soft_paraboloids: texture_2d_array<f32>;
@group(1) @binding(6) var<storage, read> samples: array<SampleRecord>;

const LEAST_COSINE: f32 = 1e-4;

fn soft_texel_lit(point: Receiver, texel: vec2i) -> bool {
  let side = select(-1.0, 1.0, point.reach.z >= 0.0);
  let layer = point.layer + select(0, 1, side < 0.0);
  let stored = textureLoad(soft_paraboloids, texel, layer, 0).x;
  let u = (vec2f(texel) + 0.5) * (2.0 / SOFT_MAP_SIZE) - 1.0;
  return plane_is_nearer(point, u, side, stored);
}

fn soft_sample_share(point: Receiver, place: vec2f) -> f32 {
  let corner = clamp(vec2i(floor(place - 0.5)), vec2i(0), vec2i(i32(SOFT_MAP_SIZE) - 2));
  let lit = vec4<bool>(
    soft_texel_lit(point, corner),
    soft_texel_lit(point, corner + vec2i(1, 0)),
    soft_texel_lit(point, corner + vec2i(0, 1)),
    soft_texel_lit(point, corner + vec2i(1, 1)),
  );
  return bilinear(lit, place, corner);
}

// Share of the lamp's light that arrives: `count` samples from `first` on, whose maps begin at
// `layer`. Where the first `probes`, which are the farthest apart, all see the receiver or all do
// not, the others are not asked: penumbrae are a small part of most pictures.
fn soft_share(
  first: i32, count: i32, probes: i32, layer: i32, position: vec3f, normal: vec3f, bias: f32,
) -> vec3f {
  var arrives = vec3f(0.0);
  var whole = vec3f(0.0);
  var seen = 0.0;
  var end = count;
  for (var i = 0; i < end; i++) {
    let record = samples[first + i];
    let reach = position - record.point;
    let inverse = inverseSqrt(max(dot(reach, reach), 1e-12));
    let distance = 1.0 / inverse;
    let away = dot(normal, reach);
    let leaving = dot(record.normal, reach) * inverse;
    var face = select(leaving, abs(leaving), record.sides > 1.5);
    face = select(max(face, LEAST_COSINE), 1.0, record.sides < 0.5);
    let weight = record.light * (max(-away * inverse, LEAST_COSINE) * face * inverse * inverse);
    let place = reach.xy * (0.5 * SOFT_MAP_SIZE / (distance + abs(reach.z))) + 0.5 * SOFT_MAP_SIZE;
    let receiver = Receiver(0, layer + 2 * i, reach, normal, away + bias);
    let share = soft_sample_share(receiver, place);
    arrives += weight * share;
    whole += weight;
    seen += share;
    let agree = seen == 0.0 || seen == f32(probes);
    end = select(end, probes, i + 1 == probes && agree);
  }
  return arrives / max(whole, vec3f(1e-20));
}
