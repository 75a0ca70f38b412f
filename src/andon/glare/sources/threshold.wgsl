// In units of the picture; stage.py writes the scene's own in place of this.

const THRESHOLD: f32 = 1.0f;
