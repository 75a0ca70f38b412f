// The layers over the frame's picture: small discs gathered here, larger ones from the pyramid.
//
// Written with alpha = coverage: the frame is blended with what is left of 1.

//!import andon/glass/defocus/discs.wgsl

@group(0) @binding(0) var linear: sampler;
@group(0) @binding(1) var table: texture_2d<f32>;
@group(0) @binding(2) var refracted: texture_2d<f32>;
@group(0) @binding(3) var surface: texture_2d<f32>;
@group(0) @binding(4) var reflected: texture_2d<f32>;
@group(0) @binding(5) var sizes: texture_2d<f32>;
@group(0) @binding(6) var coarse_refracted: texture_2d<f32>;
@group(0) @binding(7) var coarse_surface: texture_2d<f32>;
@group(0) @binding(8) var coarse_reflected: texture_2d<f32>;
@group(0) @binding(9) var coarse_rim: texture_2d<f32>;
@group(0) @binding(10) var whole: texture_2d<f32>;

fn coarse(source: texture_2d<f32>, pixel: vec2f) -> vec4f {
  return textureSampleLevel(source, linear, 0.5 * pixel / vec2f(textureDimensions(source)), 0.0);
}

// Reach in pixels of a disc that is gathered at full size; −1 where none is.
fn near_rows(d: f32, share: f32, size: f32) -> i32 {
  return select(-1, i32(reach_of(size)), d >= 1.0 && share < 1.0);
}

struct Near {
  light: vec4f,
  cover: f32,
  total: f32,
}

// Far from the rim coverage is 1, and only light is read. Two loops, of which one has no rounds:
// a condition inside would cost both reads on machines that run many pixels in step.
fn near(source: texture_2d<f32>, place: vec2i, rows: i32, size: f32) -> Near {
  let end = vec2i(textureDimensions(source)) - 1;
  let is_whole = textureLoad(whole, place >> vec2u(WHOLE), 0).x >= 1.0;
  let inner = select(-1, rows, is_whole);
  let outer = select(rows, -1, is_whole);
  var sum = Near(vec4f(0.0), 0.0, 0.0);
  for (var y = -inner; y <= inner; y++) {
    let columns = chord(reach_of(size), y);
    for (var x = -columns; x <= columns; x++) {
      let w = weight(f32(x * x + y * y), size);
      sum.light += w * textureLoad(source, clamp(place + vec2i(x, y), vec2i(0), end), 0);
      sum.total += w;
    }
  }
  sum.cover = sum.total;
  for (var y = -outer; y <= outer; y++) {
    let columns = chord(reach_of(size), y);
    for (var x = -columns; x <= columns; x++) {
      let at = clamp(place + vec2i(x, y), vec2i(0), end);
      let w = weight(f32(x * x + y * y), size);
      sum.light += w * textureLoad(source, at, 0);
      sum.cover += w * textureLoad(sizes, at, 0).x;
      sum.total += w;
    }
  }
  return sum;
}

// Light of an image at a pixel, not premultiplied; without coverage what the pyramid goes on with.
fn seen(
  source: texture_2d<f32>, enlarged: vec4f, place: vec2i, cover: f32, blurs: bool, nears: bool,
) -> vec3f {
  let own = textureLoad(source, place, 0);
  let sharp = own.xyz / max(cover, 1e-6);
  let d = diameter(own.w / max(cover, 1e-6));
  let share = select(coarser(d, FIRST), 1.0, cover == 0.0);
  if (!blurs) {
    return select(sharp, enlarged.xyz, cover == 0.0);
  }
  if (!nears) {
    return enlarged.xyz;
  }
  let size = size_of(table, min(d, FIRST));
  let rows = near_rows(d, share, size);
  let sum = near(source, place, rows, size);
  return mix(select(sharp, sum.light.xyz / max(sum.cover, 1e-6), rows >= 0), enlarged.xyz, share);
}

@fragment fn compose(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  let own = textureLoad(sizes, place, 0).xy;
  var sheet = textureLoad(surface, place, 0);
  var cover = own.x;
  if (BLURS.y) {
    let enlarged = coarse(coarse_rim, pixel.xy).xy;
    var share = 1.0;
    if (NEARS.y) {
      let d = diameter(select(own.y / max(own.x, 1e-6), enlarged.y, own.x == 0.0));
      share = coarser(d, FIRST);
      let size = size_of(table, min(d, FIRST));
      let rows = near_rows(d, share, size);
      let sum = near(surface, place, rows, size);
      sheet = select(sheet, sum.light / max(sum.total, 1e-6), rows >= 0);
      cover = select(cover, sum.cover / max(sum.total, 1e-6), rows >= 0);
    }
    sheet = mix(sheet, coarse(coarse_surface, pixel.xy), share);
    cover = saturate(mix(cover, enlarged.x, share));
  }
  let through = seen(refracted, coarse(coarse_refracted, pixel.xy), place, own.x, BLURS.x, NEARS.x);
  let mirrored = seen(reflected, coarse(coarse_reflected, pixel.xy), place, own.x, BLURS.z, NEARS.z);
  let light = sheet.xyz + max(cover - sheet.w, 0.0) * through + cover * mirrored;
  return vec4f(max(light, vec3f(0.0)), cover);
}
