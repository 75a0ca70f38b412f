// Weight of halo and needles over luminance; `least` is 40 times the ambient level. See gate.py.

const RAMP: f32 = 1.25;

fn gate(luminance: f32, least: f32) -> f32 {
  let along = clamp((luminance - least) / max(least * (RAMP - 1.0), 1e-30), 0.0, 1.0);
  return along * along * (3.0 - 2.0 * along);
}
