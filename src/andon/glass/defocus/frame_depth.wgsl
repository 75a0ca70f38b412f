// What all passes over the frame's depths share: diameters, and what is of one thing.

//!struct FrameRecord
//!import andon/gbuffer/gbuffer.wgsl
//!import andon/glass/defocus/frame_level.wgsl

@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var<uniform> frame: FrameRecord;
// What a pass reads first; a: vergence.
@group(0) @binding(4) var light: texture_2d<f32>;

// Blurs that differ by more than this within a texel are of two things, px.
const EDGE_PX: f32 = 2.0;

// Diameter in pixels of what has this vergence.
fn diameter_of(vergence: f32, per_dioptre: f32) -> f32 {
  return min(abs(vergence - frame.focus_dioptres) * per_dioptre, frame.largest_px);
}

// Weight of what differs by `off` pixels of blur: near 1 on slanted planes, next to none over edges.
fn alike(off: f32) -> f32 {
  let squared = off * off / (EDGE_PX * EDGE_PX);
  return 1.0 / (1.0 + squared * squared * squared);
}
