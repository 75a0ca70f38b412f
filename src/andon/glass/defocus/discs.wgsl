// Weights of a disc, and where one level gives way to the next; kernels.py has the reference.

//!import andon/glass/defocus/kernel.wgsl

// Diameters, of equal second moment where the kind is not a disc; at most LARGEST_PX.
fn diameter(blur_px: f32) -> f32 {
  let d = clamp(blur_px, 0.0, LARGEST_PX);
  if (IS_PAPER) {
    return 4.0 * sqrt(papers_variance(d));
  }
  return d;
}

// Second moment in px² of the paper's weights exp(−i²/K): less than its σ² = K/2, since its window
// of ±K/2 cuts them. It grows in steps, from K = 2 px on.
fn papers_variance(k: f32) -> f32 {
  var sum = vec2f(1.0, 0.0);
  for (var i = 1.0; 2.0 * i <= k; i += 1.0) {
    sum += 2.0 * exp(-i * i / k) * vec2f(1.0, i * i);
  }
  return sum.y / sum.x;
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
