// Nothing hides a probe.

//!import andon/transport/probes/hull.wgsl
//!import andon/transport/probes/irradiance.wgsl

fn probe_lux(position: vec3f, normal: vec3f) -> vec3f {
  let mix = locate(position);
  var lux = vec3f(0.0);
  for (var k = 0; k < 4; k++) {
    lux += mix.weights[k] * irradiance(mix.probes[k], normal);
  }
  return max(lux, vec3f(0.0));
}
