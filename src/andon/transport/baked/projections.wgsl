// Where a map sees a point: texel coordinates (centres at whole numbers) of its own view.

//!import andon/gpu/pi.wgsl
//!import andon/transport/baked/constants.wgsl
//!import andon/transport/baked/settings.wgsl
//!struct BakedMap

const BAKED_KIND_PINHOLE: i32 = 0;
const BAKED_KIND_FISHEYE: i32 = 1;
const BAKED_KIND_LATLONG: i32 = 2;

// x, y and, in z, whether the map looks there at all.
fn pinhole_texel(seen: BakedMap, p: vec3f) -> vec3f {
  let scale = 1.0 / max(p.z, 1e-20);
  return vec3f(p.xy * scale * seen.focal + seen.centre, select(0.0, 1.0, p.z > 0.0));
}

// Straight behind a fisheye every azimuth is as good.
fn fisheye_texel(seen: BakedMap, p: vec3f) -> vec3f {
  let planar = length(p.xy);
  let scale = select(1.0 / max(p.z, 1e-20), atan2(planar, p.z) / max(planar, 1e-20), planar > 0.0);
  let sees = planar > 0.0 || p.z > 0.0;
  return vec3f(p.xy * scale * seen.focal + seen.centre, select(0.0, 1.0, sees));
}

fn latlong_texel(seen: BakedMap, p: vec3f) -> vec3f {
  let azimuth = atan2(p.x, p.z);
  let elevation = atan2(-p.y, length(p.xz));
  let share = vec2f(azimuth / (2.0 * PI) + 0.5, 0.5 - elevation / PI);
  return vec3f(share * seen.size - 0.5, 1.0);
}

// `reach` runs from the map's camera to the point, in world axes.
fn map_texel(seen: BakedMap, reach: vec3f) -> vec3f {
  let p = vec3f(dot(seen.right, reach), dot(seen.down, reach), dot(seen.forward, reach));
  var at = vec3f(0.0);
  if (BAKED_PINHOLE && seen.kind == BAKED_KIND_PINHOLE) { at = pinhole_texel(seen, p); }
  if (BAKED_FISHEYE && seen.kind == BAKED_KIND_FISHEYE) { at = fisheye_texel(seen, p); }
  if (BAKED_LATLONG && seen.kind == BAKED_KIND_LATLONG) { at = latlong_texel(seen, p); }
  return at;
}

// 0 outside the map, rising to 1 well within.
fn border_share(seen: BakedMap, at: vec2f) -> f32 {
  if (BAKED_LATLONG && seen.kind == BAKED_KIND_LATLONG) { return 1.0; }
  let beyond = min(at + 0.5, seen.size - 0.5 - at);
  let within = min(beyond.x, beyond.y);
  return select(0.0, clamp(within / seen.border, BAKED_LEAST_WEIGHT, 1.0), within >= 0.0);
}

// Texels per m² of a surface that faces the camera.
fn texel_density(seen: BakedMap, reach: vec3f) -> f32 {
  let along = dot(seen.forward, reach);
  let planar = seen.kind == BAKED_KIND_PINHOLE;
  return seen.rate / max(select(dot(reach, reach), along * along, planar), 1e-30);
}
