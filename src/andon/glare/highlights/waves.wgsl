// Ripples of water: slopes_at of waves.py.

//!struct WaveRecord

@group(3) @binding(1) var<storage, read> waves: array<WaveRecord>;

// Slopes along x and z, and the variance of slope that a pixel blurs; `range` is first and count.
fn slopes_at(range: vec2u, position: vec3f, steps: array<vec3f, 2>) -> vec3f {
  var found = vec3f(0.0);
  for (var i = 0u; i < range.y; i++) {
    let wave = waves[range.x + i];
    let phases = vec2f(dot(steps[0].xz, wave.number), dot(steps[1].xz, wave.number));
    let kept = exp(-dot(phases, phases) / 24.0);
    let angle = dot(position.xz, wave.number) + wave.phase;
    let slope = wave.slope * kept * cos(angle);
    found += vec3f(slope * normalize(wave.number), 0.5 * wave.slope * wave.slope * (1.0 - kept * kept));
  }
  return found;
}
