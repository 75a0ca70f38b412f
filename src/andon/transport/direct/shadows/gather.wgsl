// Four texels of a paraboloid in one read: a third cheaper than four on a software rasteriser, and
// exact, since nothing is filtered.

@group(1) @binding(9) var nearest: sampler;

// How much of a point is seen: each of the four texels around the receiver's place in the map asks
// whether the receiver's plane is nearer than what it holds.
fn gathered_share(map: texture_2d_array<f32>, size: f32, point: Receiver, place: vec2f) -> f32 {
  let corner = clamp(floor(place - 0.5), vec2f(0.0), vec2f(size - 2.0));
  let side = select(-1.0, 1.0, point.reach.z >= 0.0);
  let layer = max(point.layer, 0) + select(0, 1, side < 0.0);
  // Counter-clockwise from the lower left: (0, 1), (1, 1), (1, 0), (0, 0).
  let stored = textureGather(0, map, nearest, (corner + 1.0) / size, layer);
  let low = (corner + 0.5) * (2.0 / size) - 1.0;
  let high = low + 2.0 / size;
  let lit = vec4<bool>(
    plane_is_nearer(point, low, side, stored.w),
    plane_is_nearer(point, vec2f(high.x, low.y), side, stored.z),
    plane_is_nearer(point, vec2f(low.x, high.y), side, stored.x),
    plane_is_nearer(point, high, side, stored.y),
  );
  return bilinear(lit, place, vec2i(corner));
}
