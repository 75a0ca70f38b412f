// One map. The stage exchanges this module for one that names every map of the moments in use
// (records.py).

//!import andon/transport/baked/lookup.wgsl

fn baked_earlier(position: vec3f, normal: vec3f) -> vec4f {
  return known_light(map_light(baked_maps[0], position, normal, 0.0));
}

fn baked_later(position: vec3f, normal: vec3f) -> vec4f {
  return vec4f(0.0);
}
