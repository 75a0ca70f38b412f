// What reaches a surface from a lamp where no glass is; exchanged for balls.wgsl where some is.

// The straight line to a lamp: `reach` = P − lamp (of directional lamps: − the middle of the map),
// `free` = illuminance without obstacles and `lit` the share of it that arrives, where it shines
// with `relative` of its intensity; `seen` is the share that its shadow map lets through.
struct Straight {
  position: vec3f,
  normal: vec3f,
  free: f32,
  lit: f32,
  seen: f32,
  relative: f32,
};

fn received(lamp: i32, line: Straight) -> vec3f {
  return lamps[lamp].light * (line.free * line.lit) * line.relative;
}
