// Soft shadows: the mean of what points on an area lamp see (soft.py).

//!import andon/transport/direct/shadows/gather.wgsl
//!import andon/transport/direct/shadows/soft_linear.wgsl
//!struct SampleRecord

// Paraboloid pairs around the samples of all area lamps, and the samples.
@group(1) @binding(5) var soft_paraboloids: texture_2d_array<f32>;
@group(1) @binding(6) var<storage, read> samples: array<SampleRecord>;

const LEAST_COSINE: f32 = 1e-4;

// The lift of `Receiver`. These maps are coarse, and lamps in them are near and many: RMSE against
// Radiance with 64 samples is 0.045 without a lift, 0.043 for ¼ texel, 0.048 for ½, 0.067 for 1
// (relight.soft.rmse). A quarter is enough on curved objects: none of a torus is falsely dark, of
// which 61 % are without.
const SOFT_LIFT_TEXELS: f32 = 0.25;

// What one sample gives to a receiver, up to a factor; `reach` = receiver − sample.
fn sample_weight(record: SampleRecord, reach: vec3f, away: f32) -> vec3f {
  let inverse = inverseSqrt(max(dot(reach, reach), 1e-12));
  let leaving = dot(record.normal, reach) * inverse;
  var face = select(leaving, abs(leaving), record.sides > 1.5);
  face = select(max(face, LEAST_COSINE), 1.0, record.sides < 0.5);
  return record.light * (max(-away * inverse, LEAST_COSINE) * face * inverse * inverse);
}

// What arrives of a lamp's `light`. `wanted` is its first sample, how many there are (0: it has no
// shadow), and how many of these are probes: where the probes, which are the farthest apart, all see
// the receiver or all do not, the others are not asked. Penumbrae are a small part of most pictures.
fn softened(light: vec3f, wanted: vec3i, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  var arrives = vec3f(0.0);
  var whole = vec3f(0.0);
  var seen = 0.0;
  var end = select(0, wanted.y, any(light != vec3f(0.0)));
  for (var i = 0; i < end; i++) {
    let record = samples[wanted.x + i];
    let reach = position - record.point;
    let away = dot(normal, reach);
    let weight = sample_weight(record, reach, away);
    let distance = length(reach);
    let place = reach.xy * (0.5 * SOFT_MAP_SIZE / (distance + abs(reach.z) + 1e-9)) + 0.5 * SOFT_MAP_SIZE;
    let lift = max(bias, SOFT_LIFT_TEXELS * paraboloid_texel_m(distance, SOFT_MAP_SIZE));
    let receiver = Receiver(0, 2 * (wanted.x + i), reach, normal, away + lift);
    let share = soft_sample_share(receiver, place);
    arrives += weight * share;
    whole += weight;
    seen += share;
    let agree = seen == 0.0 || seen == f32(wanted.z);
    end = select(end, wanted.z, i + 1 == wanted.z && agree);
  }
  // A channel that no sample has: whatever is seen of the others.
  let plain = vec3f(seen / f32(max(end, 1)));
  let share = select(plain, arrives / max(whole, vec3f(1e-30)), whole > vec3f(1e-30));
  return light * select(share, vec3f(1.0), end == 0);
}
