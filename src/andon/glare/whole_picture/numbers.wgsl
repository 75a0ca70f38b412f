// Constants of one pass, as stage.py writes them; these are of a small pinhole picture.

// Cells beyond those that the picture covers, on each side.
const MARGIN: i32 = 2;
// Blocks that the spline of a cell reaches, along each axis.
const WINDOW = vec2i(4, 4);
const RADIUS: i32 = 2;
const TAPS = array<f32, 3>(0.5f, 0.2f, 0.05f);

fn weight_of_row(row: i32) -> f32 {
  return 1.0;
}
