// Soft shadows: the mean of what points on an area lamp see (soft.py).

//!import andon/transport/direct/shadows/gather.wgsl
//!struct SampleRecord

// Paraboloid pairs around the samples of all area lamps, and the samples.
@group(1) @binding(5) var soft_paraboloids: texture_2d_array<f32>;
@group(1) @binding(6) var<storage, read> samples: array<SampleRecord>;

const LEAST_COSINE: f32 = 1e-4;

// What arrives of a lamp's `light`: `count` samples from `first` on, whose maps begin at `layer`, say
// which share. Where the first `probes`, which are the farthest apart, all see the receiver or all
// do not, the others are not asked: penumbrae are a small part of most pictures.
fn softened(
  light: vec3f, first: i32, count: i32, probes: i32, layer: i32,
  position: vec3f, normal: vec3f, bias: f32,
) -> vec3f {
  var arrives = vec3f(0.0);
  var whole = vec3f(0.0);
  var seen = 0.0;
  var end = select(1, count, any(light != vec3f(0.0)));
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
    let share = gathered_share(soft_paraboloids, SOFT_MAP_SIZE, receiver, place);
    arrives += weight * share;
    whole += weight;
    seen += share;
    let agree = seen == 0.0 || seen == f32(probes);
    end = select(end, probes, i + 1 == probes && agree);
  }
  return light * arrives / max(whole, vec3f(1e-20));
}
