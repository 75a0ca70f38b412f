// The frame on a sphere around the eye, seen from inside.

//!import andon/glass/backdrops/frame_light.wgsl

fn frame_seen(solid: i32, origin: vec3f, direction: vec3f, footprint: Footprint) -> Seen {
  let radius = backdrops[solid].distance_m;
  let from_eye = origin - view.position;
  let along = dot(from_eye, direction);
  // The nearest point to the eye, as a vector: |e|² − along² has no digits left far away.
  let across = from_eye - along * direction;
  let half = radius * radius - dot(across, across);
  let ahead = sqrt(max(half, 0.0)) - along;
  let hit = half > 0.0 && ahead > 0.0;
  let distance = select(FAR, ahead, hit);
  let place = select(direction, from_eye + ahead * direction, hit);
  let N = select(direction, place / radius, hit);
  let moved = footprint_at(footprint, direction, N, distance);
  if (hit) { return frame_light(place, moved, distance, false); }
  return frame_light(direction, footprint.course, FAR, true);
}
