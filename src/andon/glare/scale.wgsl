// What 1 of the other picture is in units of the frame's; glare_gpu.py writes its own in place of this.

const OTHER_UNIT: f32 = 1.0f;
