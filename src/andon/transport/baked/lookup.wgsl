// One map's light at a point (reference.py). A texel is one read of 16 bytes:
//
//   x  offset of its tangent plane from the camera, f32; its last four bits: trust, 0 for no surface
//   y  normal x, y as 2 × snorm16      z  normal z as snorm16, red as half      w  green, blue

//!import andon/transport/baked/projections.wgsl
//!struct BakedSettings

@group(0) @binding(2) var baked_texels: texture_2d_array<u32>;
// The maps of two moments; 64 of each.
@group(0) @binding(3) var<uniform> baked_maps: array<BakedMap, 128>;
@group(0) @binding(4) var<uniform> baked: BakedSettings;

// Light in stored units, how far the texel's surface is the point's, and that times its trust; all
// times the texel's bilinear part.
struct BakedTap {
  light: vec3f,
  valid: f32,
  trust: f32,
};

fn baked_tap(texel: vec4u, part: f32, reach: vec3f, normal: vec3f) -> BakedTap {
  let theirs = vec3f(unpack2x16snorm(texel.y), unpack2x16snorm(texel.z).x);
  let off_plane = abs(dot(theirs, reach) - bitcast<f32>(texel.x));
  let alike = saturate((dot(theirs, normal) - BAKED_COSINE_LOW) * BAKED_COSINE_RATE);
  let trust = texel.x & 15u;
  let there = trust > 0u && off_plane < baked.depth_tolerance_m;
  let valid = select(0.0, part * alike, there);
  let light = vec3f(unpack2x16float(texel.z).y, unpack2x16float(texel.w));
  return BakedTap(valid * light, valid, valid * f32(trust));
}

// First and second column, first and second row of the texels around a place, on their page.
fn plain_corners(seen: BakedMap, first: vec2f) -> vec4i {
  let last = seen.size - 1.0;
  let low = clamp(first, vec2f(0.0), last) + seen.place;
  let high = clamp(first + 1.0, vec2f(0.0), last) + seen.place;
  return vec4i(vec4f(low.x, high.x, low.y, high.y));
}

// Latlong goes round; over a pole a row is the same row, half way round.
fn around(column: f32, row: f32, size: vec2f) -> f32 {
  let over = row < 0.0 || row >= size.y;
  let turned = column + select(0.0, floor(0.5 * size.x), over);
  return turned - size.x * floor(turned / size.x);
}

fn turned(seen: BakedMap, column: f32, row: f32) -> vec2i {
  let inside = vec2f(around(column, row, seen.size), clamp(row, 0.0, seen.size.y - 1.0));
  return vec2i(min(inside, seen.size - 1.0) + seen.place);
}

// Of the two texels around x and y, how much each counts; those outside the map do not.
fn baked_parts(seen: BakedMap, first: vec2f, part: vec2f, round: bool) -> vec4f {
  let parts = vec4f(1.0 - part.x, part.x, 1.0 - part.y, part.y);
  let inside = vec4<bool>(
    first.x >= 0.0, first.x + 1.0 < seen.size.x, first.y >= 0.0, first.y + 1.0 < seen.size.y,
  );
  return select(vec4f(0.0), parts, inside | vec4<bool>(round));
}

// Light times the map's weight, and the weight, 0 where the map is not valid.
fn looked_up(seen: BakedMap, at: vec2f, reach: vec3f, normal: vec3f, density: f32) -> vec4f {
  let first = floor(at);
  let round = BAKED_LATLONG && seen.kind == BAKED_KIND_LATLONG;
  let parts = baked_parts(seen, first, at - first, round);
  let corners = plain_corners(seen, first);
  var places = array<vec2i, 4>(corners.xz, corners.yz, corners.xw, corners.yw);
  if (round) {
    places[0] = turned(seen, first.x, first.y);
    places[1] = turned(seen, first.x + 1.0, first.y);
    places[2] = turned(seen, first.x, first.y + 1.0);
    places[3] = turned(seen, first.x + 1.0, first.y + 1.0);
  }
  let a = baked_tap(textureLoad(baked_texels, places[0], seen.layer, 0), parts.x * parts.z, reach, normal);
  let b = baked_tap(textureLoad(baked_texels, places[1], seen.layer, 0), parts.y * parts.z, reach, normal);
  let c = baked_tap(textureLoad(baked_texels, places[2], seen.layer, 0), parts.x * parts.w, reach, normal);
  let d = baked_tap(textureLoad(baked_texels, places[3], seen.layer, 0), parts.y * parts.w, reach, normal);
  let sums = a.valid + b.valid + c.valid + d.valid;
  let scale = 1.0 / max(sums, BAKED_VALID_LEAST);
  let share = (sums - BAKED_VALID_LEAST) * BAKED_VALID_RATE;
  let trust = (a.trust + b.trust + c.trust + d.trust) * (scale * BAKED_TRUST_UNIT);
  let inner = border_share(seen, at) * trust;
  let feathered = inner * inner * inner * inner * share + BAKED_LEAST_WEIGHT;
  let blended = select(density * feathered, 1.0, BAKED_FIRST_VALID);
  let light = (a.light + b.light + c.light + d.light) * scale;
  return select(0.0, blended, share > 0.0) * vec4f(light, 1.0);
}

// The same; `before` is the weight of the maps before this one.
fn map_light(seen: BakedMap, position: vec3f, normal: vec3f, before: f32) -> vec4f {
  let reach = position - seen.position;
  let facing = -dot(reach, normal) * inverseSqrt(max(dot(reach, reach), 1e-30));
  let at = map_texel(seen, reach);
  let passed = BAKED_FIRST_VALID && before > 0.0;
  var light = vec4f(0.0);
  if (facing > 0.0 && at.z > 0.0 && border_share(seen, at.xy) > 0.0 && !passed) {
    let density = min(facing * texel_density(seen, reach), BAKED_MOST_DENSITY);
    light = looked_up(seen, at.xy, reach, normal, density);
  }
  return light;
}

// The blend of what maps gave, and 1; 0 where none is valid.
fn known_light(total: vec4f) -> vec4f {
  return select(vec4f(0.0), vec4f(total.xyz / max(total.w, 1e-37), 1.0), total.w > 0.0);
}
