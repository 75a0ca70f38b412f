// Needles alone, additive: one instance each (draw in reference.py).

//!import andon/gbuffer/view.wgsl
//!struct NeedleRecord
//!struct NeedleConstants

// What a half float holds.
const LARGEST: f32 = 65504.0;

@group(0) @binding(0) var<uniform> view: ViewRecord;
@group(0) @binding(1) var<uniform> constants: NeedleConstants;
@group(0) @binding(2) var<storage> needles: array<NeedleRecord>;

// What pixels need of a needle comes with the corners: reading records in each pixel takes longer
// than all else, and beside the strip, in the quads of four that derivatives need, they read as 0.
struct NeedleCorner {
  @builtin(position) position: vec4f,
  @location(0) @interpolate(flat) source: vec4f, // and θ of the outline
  @location(1) @interpolate(flat) along: vec4f, // and the length of light of 568 nm, inverse
  @location(2) @interpolate(flat) light: vec4f, // and half the width
  @location(3) @interpolate(flat) reach: vec4f, // inverse lengths
  @location(4) @interpolate(flat) own: vec2f, // θ that this part of the needle draws
};

// Angle to each side that light reaches.
fn half_strip(needle: NeedleRecord) -> f32 {
  return max(needle.half_width, constants.least * constants.pixel) + 0.5 * constants.pixel;
}

//!import andon/glare/needles/strip_straight.wgsl

@vertex fn needle_corner(
  @builtin(vertex_index) vertex: u32,
  @builtin(instance_index) instance: u32,
) -> NeedleCorner {
  let needle = needles[instance];
  return NeedleCorner(
    strip_corner(needle, vertex),
    vec4f(needle.source, needle.start),
    vec4f(needle.along, 1.0 / needle.length),
    vec4f(needle.light, needle.half_width),
    vec4f(1.0 / needle.reach, 0.0),
    vec2f(needle.first, needle.last),
  );
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

@fragment fn needle_light(needle: NeedleCorner) -> @location(0) vec4f {
  let direction = normalize(ray_planar(needle.position.xy));
  let step_x = dpdx(direction);
  let step_y = dpdy(direction);
  let source = needle.source.xyz;
  let along = needle.along.xyz;
  let normal = cross(source, along);
  let s = dot(direction, normal);
  let x = dot(direction, source);
  let y = dot(direction, along);
  let theta = atan2(y, x);
  // Of what is averaged along the needle, and of a pixel across it.
  let outwards = (x * along - y * source) / (x * x + y * y);
  let extent = constants.extent * length(vec2f(dot(step_x, outwards), dot(step_y, outwards)));
  let width = length(vec2f(dot(step_x, normal), dot(step_y, normal)));
  let rho = theta - needle.source.w;
  let near = profile_within((rho - 0.5 * extent) * needle.reach.xyz);
  let held = profile_within((rho + 0.5 * extent) * needle.reach.xyz) - near;
  let tapered = mix(1.0, constants.taper, clamp(rho * needle.along.w, 0.0, 1.0));
  let half_width = max(needle.light.w * tapered, constants.least * width);
  let tent = tent_within((s + 0.5 * width) / half_width) - tent_within((s - 0.5 * width) / half_width);
  let mine = select(0.0, 1.0, theta >= needle.own.x && theta < needle.own.y);
  let light = needle.light.xyz * held * (mine * tent / (extent * width));
  return vec4f(min(light, vec3f(LARGEST)), 0.0);
}
