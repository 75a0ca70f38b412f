// Constants of one mode, as stage.py writes them; these are of `optical` at level 1.

// Pixels a texel, and the level's own discs: full from FIRST px on, the next level's from LAST on.
const TEXEL: f32 = 2.0;
const FIRST: f32 = 5.0;
const LAST: f32 = 13.0;
const HALF_SHARPENING: f32 = 0.1875;
// A weight ends at REACH sizes and half a texel.
const REACH: f32 = 1.0;
const IS_GAUSSIAN = false;
const IS_PAPER = false;
const LARGEST_PX: f32 = 64.0;
const STEPS: f32 = 64.0;
// Of what is refracted, sticks to the surface, is mirrored: blurred at all; discs that are small.
const BLURS = vec3<bool>(true, true, true);
const NEARS = vec3<bool>(true, true, true);
// The level whose coverage is 1 where all that small discs reach is glass.
const WHOLE: u32 = 2u;
