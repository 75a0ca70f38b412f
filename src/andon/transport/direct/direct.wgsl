// Direct illuminance of all lamps, in lux: the same functions as reference.py.

//!import andon/transport/direct/shadows/paraboloid.wgsl

//!struct LampRecord

//!struct DirectRecord

@group(1) @binding(0) var<uniform> lamps: array<LampRecord, 64>;
@group(1) @binding(1) var<uniform> direct: DirectRecord;
@group(1) @binding(2) var paraboloids: texture_2d_array<f32>;
@group(1) @binding(3) var planes: texture_depth_2d_array;

// Metres: what E = I/d² is cut at, so that a lamp on a surface gives no infinity.
const NEAREST_M: f32 = 1e-3;

// Two surfaces closer than this share of their distance are one: float32 rounding of a depth map.
const SAME_DEPTH: f32 = 2e-5;

// A shadow query: what a filter needs to ask the map at one texel. `reach` = P − lamp,
// `away` = normal·reach < 0, lifted by the bias, and by a texel at least.
//
// Why a texel: the receiver's plane is that of its shading normal. Its own facet bends away from
// that plane, and other facets beside it from both, by less than a texel within a texel. Share of
// pixels of which shadows are false (acne) + lost, in %, on virtual objects, against rays, 1024²:
//
//   lift in texels             0              ½              1              1½
//   ball of 320, sun     42.7 + 0.1      0.0 + 0.1      0.0 + 0.1      0.0 + 0.1
//   torus, point         43.0 + 0.1      0.0 + 0.2      0.0 + 0.2      0.0 + 0.2
//   walker, sun           1.1 + 0.4      0.5 + 0.4      0.5 + 0.4      0.5 + 0.4
//   walker, point         0.9 + 0.7      0.6 + 0.8      0.6 + 0.8      0.6 + 0.8
//   boxes, sun            9.4 + 0.3      3.3 + 0.3      0.7 + 0.3      0.6 + 0.3
//   furniture, sun        0.9 + 0.6      0.7 + 0.6      0.6 + 0.6      0.6 + 0.6
//   thin plates, low sun  1.1 + 0.8      0.8 + 0.8      0.6 + 0.9      0.3 + 1.1
//
// Boxes and plates err at creases, where the plane of one wall runs on behind the other.
struct Receiver {
  lamp: i32,
  layer: i32,
  reach: vec3f,
  normal: vec3f,
  away: f32,
};

// Is the receiver's plane, where it passes the centre `u` of a texel, no farther than what the map
// holds there?
fn plane_is_nearer(point: Receiver, u: vec2f, side: f32, stored: f32) -> bool {
  let centre = paraboloid_direction(u, side);
  // distance of the plane along `centre` = away·(1+|u|²)/(normal·centre), both negative.
  return point.away * (1.0 + dot(u, u)) >= stored * (1.0 + SAME_DEPTH) * dot(point.normal, centre);
}

fn paraboloid_texel_lit(point: Receiver, texel: vec2i) -> bool {
  let side = select(-1.0, 1.0, point.reach.z >= 0.0);
  let layer = max(point.layer, 0) + select(0, 1, side < 0.0);
  let stored = textureLoad(paraboloids, texel, layer, 0).x;
  return plane_is_nearer(point, (vec2f(texel) + 0.5) * (2.0 / MAP_SIZE) - 1.0, side, stored);
}

fn point_illuminance(lamp: i32, layer: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  return light_of_point(lamp, layer, position, normal, bias, 1.0);
}

// `relative`: share of the lamp's intensity that it has in the direction of `position`.
fn light_of_point(lamp: i32, layer: i32, position: vec3f, normal: vec3f, bias: f32, relative: f32) -> vec3f {
  let reach = position - lamps[lamp].position;
  let distance = length(reach);
  let inverse = 1.0 / max(distance, NEAREST_M);
  let away = dot(normal, reach);
  let place = reach.xy * (0.5 * MAP_SIZE / max(distance + abs(reach.z), 1e-9)) + 0.5 * MAP_SIZE;
  let lift = max(bias, PARABOLOID_LIFT_TEXELS * paraboloid_texel_m(distance, MAP_SIZE));
  let seen = paraboloid_share(Receiver(lamp, layer, reach, normal, away + lift), place);
  let lit = select(seen, 1.0, layer < 0);
  let free = max(-away, 0.0) * inverse * inverse * inverse;
  return received(lamp, Straight(position, normal, free, lit, lit, relative));
}

fn cone_ramp(lamp: i32, cosine: f32) -> f32 {
  let ramp = clamp(cosine * lamps[lamp].cone_scale + lamps[lamp].cone_offset, 0.0, 1.0);
  return ramp * ramp;
}

fn wide_spot_illuminance(lamp: i32, layer: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  let reach = position - lamps[lamp].position;
  let cosine = dot(lamps[lamp].axis, reach) * inverseSqrt(dot(reach, reach));
  return light_of_point(lamp, layer, position, normal, bias, cone_ramp(lamp, cosine));
}

fn spot_texel_lit(point: Receiver, texel: vec2i) -> bool {
  let record = lamps[point.lamp];
  let centre = ((vec2f(texel) + 0.5) * (2.0 / MAP_SIZE) - 1.0) * record.half_width;
  let direction = record.axis + record.right * centre.x + record.down * centre.y;
  let stored = textureLoad(planes, texel, max(point.layer, 0), 0);
  // depth of the plane = away/(normal·direction); the map holds near/depth.
  return point.away * stored >= direct.near_m * (1.0 + SAME_DEPTH) * dot(point.normal, direction);
}

fn spot_illuminance(lamp: i32, layer: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  let record = lamps[lamp];
  let reach = position - record.position;
  let inverse = inverseSqrt(max(dot(reach, reach), NEAREST_M * NEAREST_M));
  let away = dot(normal, reach);
  let along = dot(record.axis, reach);
  let tangent = vec2f(dot(record.right, reach), dot(record.down, reach)) / along;
  let place = (tangent / record.half_width * 0.5 + 0.5) * MAP_SIZE;
  let lift = max(bias, along * record.half_width * (2.0 / MAP_SIZE));
  let found = spot_share(Receiver(lamp, layer, reach, normal, away + lift), place);
  let ramp = cone_ramp(lamp, along * inverse);
  let seen = select(found, 1.0, layer < 0 || ramp <= 0.0); // no map beside the cone
  let free = max(-away, 0.0) * inverse * inverse * inverse;
  return received(lamp, Straight(position, normal, free, ramp * seen, seen, 1.0));
}

fn directional_texel_lit(point: Receiver, texel: vec2i) -> bool {
  let record = lamps[point.lamp];
  let centre = ((vec2f(texel) + 0.5) * (2.0 / MAP_SIZE) - 1.0) * record.half_width;
  let place = vec2f(dot(record.right, point.reach), dot(record.down, point.reach));
  let across = vec2f(dot(record.right, point.normal), dot(record.down, point.normal));
  let facing = min(dot(record.axis, point.normal), -1e-4);
  // `away` is the bias here: parallel light has no distance.
  let depth = dot(record.axis, point.reach) + (point.away - dot(across, centre - place)) / facing;
  let held = textureLoad(planes, texel, max(point.layer, 0), 0);
  // 0 is what the map was cleared to: nothing stands there.
  return held <= 0.0 || depth <= (0.5 - held + 1e-6) * record.depth_range_m;
}

fn directional_illuminance(lamp: i32, layer: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  let record = lamps[lamp];
  let reach = position - record.position;
  let at = vec2f(dot(record.right, reach), dot(record.down, reach)) / record.half_width;
  let place = (at * 0.5 + 0.5) * MAP_SIZE;
  let lift = max(bias, record.half_width * (2.0 / MAP_SIZE));
  let seen = directional_share(Receiver(lamp, layer, reach, normal, lift), place);
  let beyond = layer < 0 || any(abs(at) > vec2f(1.0));
  let lit = select(seen, 1.0, beyond);
  return received(lamp, Straight(position, normal, max(-dot(record.axis, normal), 0.0), lit, lit, 1.0));
}

fn hemisphere_illuminance(lamp: i32, normal: vec3f) -> vec3f {
  let sky = 0.5 + 0.5 * dot(normal, lamps[lamp].axis);
  return mix(lamps[lamp].right, lamps[lamp].light, sky);
}

//!import andon/transport/direct/balls/none.wgsl
//!import andon/transport/direct/shadows/bilinear.wgsl
//!import andon/transport/direct/shadows/filter_none.wgsl
//!import andon/transport/direct/soft.wgsl
//!import andon/transport/direct/area_lamps.wgsl
//!import andon/transport/direct/luminaires.wgsl
//!import andon/transport/direct/sum.wgsl
