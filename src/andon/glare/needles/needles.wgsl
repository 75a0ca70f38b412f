// Needles alone, additive: one instance each (draw in reference.py).

//!import andon/gbuffer/view.wgsl
//!struct NeedleRecord
//!struct NeedleConstants

@group(0) @binding(0) var<uniform> view: ViewRecord;
@group(0) @binding(1) var<uniform> constants: NeedleConstants;
@group(0) @binding(2) var<storage> needles: array<NeedleRecord>;

// Clip position, and the θ that this part of the strip draws.
struct StripCorner {
  clip: vec4f,
  own: vec2f,
};

struct NeedleCorner {
  @builtin(position) position: vec4f,
  @location(0) @interpolate(flat) index: u32,
  @location(1) @interpolate(flat) own: vec2f,
};

//!import andon/glare/needles/strip_straight.wgsl

@vertex fn needle_corner(
  @builtin(vertex_index) vertex: u32,
  @builtin(instance_index) instance: u32,
) -> NeedleCorner {
  let corner = strip_corner(needles[instance], vertex);
  return NeedleCorner(corner.clip, instance, corner.own);
}

fn profile_within(along: vec3f) -> vec3f {
  let x = clamp(along, vec3f(0.0), vec3f(1.0));
  let fallen = 1.0 - pow(1.0 + x / constants.knee, vec3f(1.0 - constants.power));
  return (fallen * constants.knee / (constants.power - 1.0) - constants.end * x) * constants.scale;
}

fn tent_within(across: f32) -> f32 {
  let x = clamp(across, -1.0, 1.0);
  return 0.5 + x - 0.5 * x * abs(x);
}

@fragment fn needle_light(corner: NeedleCorner) -> @location(0) vec4f {
  let direction = normalize(ray_planar(corner.position.xy));
  // Of the direction, which every pixel of a quad of four has: beside the strip records read as 0.
  let step_x = dpdx(direction);
  let step_y = dpdy(direction);
  let needle = needles[corner.index];
  let normal = cross(needle.source, needle.along);
  let s = dot(direction, normal);
  let x = dot(direction, needle.source);
  let y = dot(direction, needle.along);
  let theta = atan2(y, x);
  // Of what is averaged along the needle, and of a pixel across it.
  let outwards = (x * needle.along - y * needle.source) / (x * x + y * y);
  let extent = constants.extent * length(vec2f(dot(step_x, outwards), dot(step_y, outwards)));
  let width = length(vec2f(dot(step_x, normal), dot(step_y, normal)));
  let rho = theta - needle.start;
  let ends = vec2f(rho - 0.5 * extent, rho + 0.5 * extent);
  let held = profile_within(ends.y / needle.reach) - profile_within(ends.x / needle.reach);
  let tapered = mix(1.0, constants.taper, clamp(rho / needle.length, 0.0, 1.0));
  let half_width = max(needle.half_width * tapered, constants.least * width);
  let tent = tent_within((s + 0.5 * width) / half_width) - tent_within((s - 0.5 * width) / half_width);
  let mine = select(0.0, 1.0, theta >= corner.own.x && theta < corner.own.y);
  return vec4f(needle.light * held * (mine * tent / (extent * width)), 0.0);
}
