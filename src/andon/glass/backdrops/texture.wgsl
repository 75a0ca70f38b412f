// A picture on a plane; both sides show it.

//!import andon/glass/backdrops/bindings.wgsl
//!import andon/glass/backdrops/seen.wgsl

fn texture_seen(solid: i32, origin: vec3f, direction: vec3f, footprint: Footprint) -> Seen {
  let record = backdrops[solid];
  // Of half the plane's width and height: (1, 1) is its upper right corner.
  let right = record.right / dot(record.right, record.right);
  let up = record.up / dot(record.up, record.up);
  let N = cross(right, up);
  let slope = dot(direction, N);
  let distance = dot(record.centre - origin, N) / select(slope, 1e-20, slope == 0.0);
  let hit = origin + distance * direction - record.centre;
  let place = vec2f(dot(hit, right), dot(hit, up));
  if (!(distance > 0.0 && max(abs(place.x), abs(place.y)) <= 1.0)) { return nothing_seen(); }
  let moved = footprint_at(footprint, direction, N, distance);
  let scale = 0.5 * record.picture.zw * vec2f(1.0, -1.0);
  let steps = mat2x2f(
    scale * vec2f(dot(moved[0], right), dot(moved[0], up)),
    scale * vec2f(dot(moved[1], right), dot(moved[1], up)),
  );
  let source = pyramid_at(record.picture, record.levels, vec2<bool>(false));
  let light = sampled(atlas, source, 0.5 * record.picture.zw + scale * place, steps).xyz;
  return Seen(light * record.light, distance, false, false);
}
