// What texels.py says of weights; a test holds both against each other.

const BAKED_COSINE_LOW: f32 = 0.5;
// 1/(cos 30° − cos 60°)
const BAKED_COSINE_RATE: f32 = 2.7320508;
const BAKED_VALID_LEAST: f32 = 1e-3;
const BAKED_VALID_RATE: f32 = 1.001001;
// A step of trust.
const BAKED_TRUST_UNIT: f32 = 0.07692308;
const BAKED_MOST_DENSITY: f32 = 1e10;
const BAKED_LEAST_WEIGHT: f32 = 1e-8;
