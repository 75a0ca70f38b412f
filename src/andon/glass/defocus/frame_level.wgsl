// Constants of one level, as frame_stage.py writes them; these are of full size.

//!import andon/gpu/pi.wgsl

const TEXEL: f32 = 1.0;
// Diameters in pixels between which a disc becomes this level's, and the next one's.
const FIRST = vec2f(-2.0, -1.0);
const LAST = vec2f(3.4, 4.6);
const HALF_SHARPENING: f32 = 0.0;
const REACH: i32 = 2;
const STEPS: f32 = 64.0;
// Texels between those that a round of ranges takes together.
const APART: i32 = 1;
