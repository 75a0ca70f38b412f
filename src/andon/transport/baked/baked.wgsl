// Maps projected onto a point (reference.py). All maps of the moments in use lie in one picture: a
// texel is one read of 16 bytes. Where no pixel of a group needs a map's texels they are not read:
// that is what loops of no or one step are for, a software rasteriser takes both sides of a branch.

//!import andon/gpu/octahedral.wgsl
//!import andon/transport/baked/projections.wgsl
//!struct BakedSettings

// x: offset of the tangent plane from the camera, f32 bits; y: normal; z: red, green; w: blue, trust
@group(0) @binding(2) var baked_texels: texture_2d_array<u32>;
@group(0) @binding(3) var<uniform> baked_maps: array<BakedMap, 128>;
@group(0) @binding(4) var<uniform> baked: BakedSettings;

// Lux (stored units) and how far the texel's surface is the point's, times its bilinear part; and,
// in `trust`, that times its trust.
struct BakedTap {
  light: vec4f,
  trust: f32,
};

fn baked_tap(texel: vec4u, part: f32, reach: vec3f, normal: vec3f) -> BakedTap {
  let theirs = octahedral_decode(texel.y);
  let off_plane = abs(dot(theirs, reach) - bitcast<f32>(texel.x));
  let alike = clamp((dot(theirs, normal) - BAKED_COSINE_LOW) / BAKED_COSINE_SPAN, 0.0, 1.0);
  let last = unpack2x16float(texel.w);
  let there = last.y > 0.0 && off_plane < baked.depth_tolerance_m;
  let weight = select(0.0, part * alike * alike * (3.0 - 2.0 * alike), there);
  return BakedTap(weight * vec4f(unpack2x16float(texel.z), last.x, 1.0), weight * last.y);
}

// Latlong goes round, and over the poles down on the other side.
fn baked_texel(seen: BakedMap, at: vec2f) -> vec4u {
  var place = at;
  if (BAKED_LATLONG && seen.kind == BAKED_KIND_LATLONG) {
    let over = at.y < 0.0 || at.y >= seen.size.y;
    let column = at.x + select(0.0, floor(0.5 * seen.size.x), over);
    place.x = column - seen.size.x * floor(column / seen.size.x);
  }
  place = clamp(place, vec2f(0.0), seen.size - 1.0) + seen.place;
  return textureLoad(baked_texels, vec2i(place), seen.layer, 0);
}

// Of the two texels around x (or y), how much each counts: those outside the map do not.
fn baked_parts(part: f32, first: f32, size: f32, goes_round: bool) -> vec2f {
  let inside = vec2<bool>(first >= 0.0 || goes_round, first + 1.0 < size || goes_round);
  return select(vec2f(0.0), vec2f(1.0 - part, part), inside);
}

// Lux times the map's weight, and the weight.
fn looked_up(seen: BakedMap, at: vec2f, reach: vec3f, normal: vec3f, density: f32) -> vec4f {
  let first = floor(at);
  let part = at - first;
  let round = BAKED_LATLONG && seen.kind == BAKED_KIND_LATLONG;
  let x = baked_parts(part.x, first.x, seen.size.x, round);
  let y = baked_parts(part.y, first.y, seen.size.y, round);
  let a = baked_tap(baked_texel(seen, first), x.x * y.x, reach, normal);
  let b = baked_tap(baked_texel(seen, first + vec2f(1.0, 0.0)), x.y * y.x, reach, normal);
  let c = baked_tap(baked_texel(seen, first + vec2f(0.0, 1.0)), x.x * y.y, reach, normal);
  let d = baked_tap(baked_texel(seen, first + vec2f(1.0, 1.0)), x.y * y.y, reach, normal);
  let light = a.light + b.light + c.light + d.light;
  let sums = max(light.w, BAKED_VALID_LEAST);
  let share = (light.w - BAKED_VALID_LEAST) / (1.0 - BAKED_VALID_LEAST);
  let trust = (a.trust + b.trust + c.trust + d.trust) / sums;
  let feathered = border_share(seen, at) * trust * share + BAKED_LEAST_WEIGHT;
  let blended = select(density * density * feathered, 1.0, BAKED_FIRST_VALID);
  return select(0.0, blended, share > 0.0) * vec4f(light.xyz / sums, 1.0);
}

// Lux (stored units) of a moment, and 1 where a map sees the point.
fn baked_moment(slot: i32, position: vec3f, normal: vec3f) -> vec4f {
  var total = vec4f(0.0);
  for (var number = 0; number < baked.map_count; number++) {
    let seen = baked_maps[slot * 64 + number];
    let reach = position - seen.position;
    let facing = -dot(reach, normal) * inverseSqrt(max(dot(reach, reach), 1e-30));
    let at = map_texel(seen, reach);
    let needed = facing > 0.0 && at.z > 0.0 && border_share(seen, at.xy) > 0.0
      && !(BAKED_FIRST_VALID && total.w > 0.0);
    let density = min(facing * texel_density(seen, reach), BAKED_MOST_DENSITY);
    let last = select(0, 1, needed);
    for (var step = 0; step < last; step++) {
      total += looked_up(seen, at.xy, reach, normal, density);
    }
  }
  let covered = total.w > 0.0;
  return select(vec4f(0.0), vec4f(total.xyz / max(total.w, 1e-37), 1.0), covered);
}

// Illuminance in lux (xyz), and 1 where it is known (w).
fn baked_lux(position: vec3f, normal: vec3f) -> vec4f {
  var moments = array<vec4f, 2>(vec4f(0.0), vec4f(0.0));
  for (var k = 0; k < baked.moment_count; k++) {
    let slot = select(baked.later_slot, baked.earlier_slot, k == 0);
    let scale = select(baked.later_scale, baked.earlier_scale, k == 0);
    moments[k] = baked_moment(slot, position, normal) * vec4f(vec3f(scale), 1.0);
  }
  let both = select(baked.later_share, 1.0, moments[0].w == 0.0);
  let share = select(0.0, both, moments[1].w > 0.0);
  let lux = mix(moments[0].xyz, moments[1].xyz, share);
  return vec4f(lux, max(moments[0].w, moments[1].w));
}
