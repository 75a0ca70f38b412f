// Weights of a disc, and where one level gives way to the next; kernels.py has the reference.

//!import andon/glass/defocus/kernel.wgsl

// Diameters, of equal second moment where the kind is not a disc; at most LARGEST_PX. The paper's
// σ² = K/2 is less where its window of ±K/2 cuts it: fitted within 0.15 px² from K = 2 px on.
fn diameter(blur_px: f32) -> f32 {
  let d = clamp(blur_px, 0.0, LARGEST_PX);
  return select(d, sqrt(8.0 * d * (1.0 - exp(-d / 3.6))) * f32(d >= 1.0), IS_PAPER);
}

// Radius or σ in texels of a diameter in texels, from the table.
fn size_of(table: texture_2d<f32>, texels: f32) -> f32 {
  return textureLoad(table, vec2i(i32(texels * STEPS + 0.5), 0), 0).x;
}

fn reach_of(size: f32) -> f32 {
  return REACH * size + 0.5;
}

fn weight(r2: f32, size: f32) -> f32 {
  let edge = saturate(reach_of(size) - sqrt(r2));
  return select(edge, edge * exp(-0.5 * r2 / (size * size)), IS_GAUSSIAN);
}

// Half the chord of a disc at a row, whole texels; −1 where there is none.
fn chord(reach: f32, row: i32) -> i32 {
  let left = reach * reach - f32(row * row);
  return select(-1, i32(sqrt(max(left, 0.0))), left > 0.0);
}

// Share of the coarser level: 0 below 0.85 of where it is to have all, 1 from there on.
fn coarser(d: f32, all: f32) -> f32 {
  return smoothstep(0.85 * all, all, d);
}
