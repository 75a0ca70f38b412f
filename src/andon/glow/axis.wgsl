// Constants of one axis, as plan.py writes them; these are of 16 columns with σ = 4 px.

const AXIS = vec2i(1, 0);
const LENGTH: i32 = 16;
const REDUCTION: i32 = 2;
// Texel of cell 0.
const ORIGIN: i32 = 2;
const RADIUS: i32 = 1;
const TAPS = array<f32, 2>(0.4f, 0.3f);
const FRACTION: f32 = 1.0f;
const BODY_LIMIT: f32 = 32752.0f;
