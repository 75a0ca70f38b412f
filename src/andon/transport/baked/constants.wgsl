// What texels.py says of weights; a test holds both against each other.

const BAKED_COSINE_LOW: f32 = 0.5;
const BAKED_COSINE_SPAN: f32 = 0.3660254;
const BAKED_VALID_LEAST: f32 = 1e-3;
const BAKED_MOST_DENSITY: f32 = 1e10;
const BAKED_LEAST_WEIGHT: f32 = 1e-8;
