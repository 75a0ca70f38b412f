// Constants of one pass, as stage.py writes them; these are of a small pinhole picture.

// Cells beyond those that the picture covers, on each side.
const MARGIN: i32 = 2;
// Blocks that the spline of a cell reaches, along each axis.
const WINDOW = vec2i(4, 4);
// Rungs of a level, 0 to 2, the filters of each, and what lies on top of them.
const RUNGS: i32 = 1;
const RADIUS: i32 = 2;
const TAPS = array<f32, 3>(0.5f, 0.2f, 0.05f);
const WIDE_RADIUS: i32 = 2;
const WIDE_TAPS = array<f32, 3>(0.5f, 0.2f, 0.05f);
const HAS_ABOVE: bool = true;
const HAS_FAR: bool = true;
// Whether blocks have a rung of their own, and whether the first and the last are the same places.
const HAS_BLOCKS: bool = true;
const WRAPS: bool = false;
fn weight_of_row(row: i32) -> f32 {
  return 1.0;
}
