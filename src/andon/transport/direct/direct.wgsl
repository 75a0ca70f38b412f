// Direct illuminance of all lamps, in lux: the same functions as reference.py.

//!import andon/transport/direct/shadows/paraboloid.wgsl

//!struct LampRecord

//!struct DirectRecord

@group(1) @binding(0) var<uniform> lamps: array<LampRecord, 64>;
@group(1) @binding(1) var<uniform> direct: DirectRecord;
@group(1) @binding(2) var paraboloids: texture_2d_array<f32>;
@group(1) @binding(3) var planes: texture_depth_2d_array;

// Two surfaces closer than this share of their distance are one: float32 rounding of a depth map.
const SAME_DEPTH: f32 = 2e-4;

// Is the receiver's plane, where it passes the centre of the texel, no farther than what the map
// holds there? `reach` = P − lamp; `away` = normal·reach < 0, lifted by the bias.
fn paraboloid_lit(lamp: i32, reach: vec3f, distance: f32, normal: vec3f, away: f32) -> bool {
  let layer = lamps[lamp].shadow_layer;
  let size = lamps[lamp].map_size;
  let front = reach.z >= 0.0;
  let place = reach.xy * (0.5 * size / (distance + abs(reach.z))) + 0.5 * size;
  let texel = min(vec2i(place), vec2i(i32(size) - 1));
  let u = (vec2f(texel) + 0.5) * (2.0 / size) - 1.0;
  let centre = paraboloid_direction(u, select(-1.0, 1.0, front));
  let stored = textureLoad(paraboloids, texel, max(layer, 0) + select(1, 0, front), 0).x;
  // distance of the plane along `centre` = away·(1+|u|²)/(normal·centre), both negative.
  let lit = away * (1.0 + dot(u, u)) >= stored * (1.0 + SAME_DEPTH) * dot(normal, centre);
  return lit || layer < 0;
}

fn point_illuminance(lamp: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  let reach = position - lamps[lamp].position;
  let inverse = inverseSqrt(dot(reach, reach));
  let distance = dot(reach, reach) * inverse;
  let away = dot(normal, reach);
  let lit = paraboloid_lit(lamp, reach, distance, normal, away + bias);
  return lamps[lamp].light * select(0.0, max(-away, 0.0) * inverse * inverse * inverse, lit);
}

fn cone_ramp(lamp: i32, cosine: f32) -> f32 {
  let ramp = clamp(cosine * lamps[lamp].cone_scale + lamps[lamp].cone_offset, 0.0, 1.0);
  return ramp * ramp;
}

fn wide_spot_illuminance(lamp: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  let reach = position - lamps[lamp].position;
  let cosine = dot(lamps[lamp].axis, reach) * inverseSqrt(dot(reach, reach));
  return point_illuminance(lamp, position, normal, bias) * cone_ramp(lamp, cosine);
}

fn planar_texel(place: vec2f, size: f32) -> vec2i {
  return clamp(vec2i(floor((place * 0.5 + 0.5) * size)), vec2i(0), vec2i(i32(size) - 1));
}

fn spot_lit(lamp: i32, reach: vec3f, normal: vec3f, away: f32) -> bool {
  let record = lamps[lamp];
  let along = dot(record.axis, reach);
  let tangent = vec2f(dot(record.right, reach), dot(record.down, reach)) / along;
  let texel = planar_texel(tangent / record.half_width, record.map_size);
  let centre = ((vec2f(texel) + 0.5) * (2.0 / record.map_size) - 1.0) * record.half_width;
  let direction = record.axis + record.right * centre.x + record.down * centre.y;
  let stored = textureLoad(planes, texel, max(record.shadow_layer, 0), 0);
  // depth of the plane = away/(normal·direction); the map holds near/depth.
  let lit = away * stored >= direct.near_m * (1.0 + SAME_DEPTH) * dot(normal, direction);
  return lit || record.shadow_layer < 0;
}

fn spot_illuminance(lamp: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  let record = lamps[lamp];
  let reach = position - record.position;
  let inverse = inverseSqrt(dot(reach, reach));
  let away = dot(normal, reach);
  let ramp = cone_ramp(lamp, dot(record.axis, reach) * inverse);
  let lit = spot_lit(lamp, reach, normal, away + bias);
  return record.light * select(0.0, max(-away, 0.0) * inverse * inverse * inverse * ramp, lit);
}

fn directional_lit(lamp: i32, reach: vec3f, normal: vec3f, bias: f32) -> bool {
  let record = lamps[lamp];
  let place = vec2f(dot(record.right, reach), dot(record.down, reach));
  let texel = planar_texel(place / record.half_width, record.map_size);
  let centre = ((vec2f(texel) + 0.5) * (2.0 / record.map_size) - 1.0) * record.half_width;
  let across = vec2f(dot(record.right, normal), dot(record.down, normal));
  let facing = min(dot(record.axis, normal), -1e-4);
  let depth = dot(record.axis, reach) + (bias - dot(across, centre - place)) / facing;
  let stored = 0.5 - textureLoad(planes, texel, max(record.shadow_layer, 0), 0);
  let lit = depth <= (stored + 1e-6) * record.depth_range_m;
  let outside = any(abs(place) > vec2f(record.half_width));
  return lit || outside || record.shadow_layer < 0;
}

fn directional_illuminance(lamp: i32, position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  let cosine = max(-dot(lamps[lamp].axis, normal), 0.0);
  let lit = directional_lit(lamp, position - lamps[lamp].position, normal, bias);
  return lamps[lamp].light * select(0.0, cosine, lit);
}

fn hemisphere_illuminance(lamp: i32, normal: vec3f) -> vec3f {
  let sky = 0.5 + 0.5 * dot(normal, lamps[lamp].axis);
  return mix(lamps[lamp].right, lamps[lamp].light, sky);
}

//!import andon/transport/direct/sum.wgsl
