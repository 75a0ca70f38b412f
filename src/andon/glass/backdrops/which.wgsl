// The kind of backdrop that all bodies have; `backdrop_variants` exchanges it.

//!import andon/glass/backdrops/texture.wgsl

fn backdrop_seen(solid: i32, origin: vec3f, direction: vec3f, footprint: Footprint) -> Seen {
  return texture_seen(solid, origin, direction, footprint);
}
