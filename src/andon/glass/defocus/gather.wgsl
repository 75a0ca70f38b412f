// Discs at one level of the pyramid, and that level's answer: sharpened, the coarser one blended in.
//
// An image is (r, g, b, D); a sheet is (r, g, b, α·coverage) and (coverage, D).

//!import andon/glass/defocus/discs.wgsl

@group(0) @binding(0) var linear: sampler;
@group(0) @binding(1) var table: texture_2d<f32>;
@group(0) @binding(2) var image: texture_2d<f32>;
@group(0) @binding(3) var rim: texture_2d<f32>;
@group(0) @binding(4) var coarse_image: texture_2d<f32>;
@group(0) @binding(5) var coarse_rim: texture_2d<f32>;

struct Sheet {
  @location(0) light: vec4f,
  @location(1) rim: vec4f,
}

// Size of the disc in texels; so small that it is one texel where another level answers.
fn local_size(blur_px: f32) -> f32 {
  let d = diameter(blur_px);
  let asked = d > 0.6 * FIRST && d < 1.2 * LAST;
  return select(0.0, size_of(table, d / TEXEL), asked);
}

@fragment fn gather_image(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  let end = vec2i(textureDimensions(image)) - 1;
  let own = textureLoad(image, place, 0);
  let size = local_size(own.w);
  let reach = reach_of(size);
  let rows = i32(reach);
  var sum = vec4f(0.0);
  for (var y = -rows; y <= rows; y++) {
    let columns = chord(reach, y);
    for (var x = -columns; x <= columns; x++) {
      let tap = textureLoad(image, clamp(place + vec2i(x, y), vec2i(0), end), 0).xyz;
      sum += weight(f32(x * x + y * y), size) * vec4f(tap, 1.0);
    }
  }
  return vec4f(select(own.xyz, sum.xyz / sum.w, size > 0.0), own.w);
}

@fragment fn gather_sheet(@builtin(position) texel: vec4f) -> Sheet {
  let place = vec2i(texel.xy);
  let end = vec2i(textureDimensions(image)) - 1;
  let own = Sheet(textureLoad(image, place, 0), textureLoad(rim, place, 0));
  let size = local_size(own.rim.y);
  let reach = reach_of(size);
  let rows = i32(reach);
  var sum = vec4f(0.0);
  var cover = vec2f(0.0);
  for (var y = -rows; y <= rows; y++) {
    let columns = chord(reach, y);
    for (var x = -columns; x <= columns; x++) {
      let at = clamp(place + vec2i(x, y), vec2i(0), end);
      let w = weight(f32(x * x + y * y), size);
      sum += w * textureLoad(image, at, 0);
      cover += w * vec2f(textureLoad(rim, at, 0).x, 1.0);
    }
  }
  let light = select(own.light, sum / cover.y, size > 0.0);
  return Sheet(light, vec4f(select(own.rim.x, cover.x / cover.y, size > 0.0), own.rim.y, 0.0, 0.0));
}

// Takes away the second moment that reducing and enlarging add: 1 + v·(2 − cos x − cos y).
fn sharper(source: texture_2d<f32>, place: vec2i) -> vec4f {
  let end = vec2i(textureDimensions(source)) - 1;
  let own = textureLoad(source, place, 0);
  let around = textureLoad(source, max(place - vec2i(1, 0), vec2i(0)), 0)
    + textureLoad(source, min(place + vec2i(1, 0), end), 0)
    + textureLoad(source, max(place - vec2i(0, 1), vec2i(0)), 0)
    + textureLoad(source, min(place + vec2i(0, 1), end), 0);
  return own + HALF_SHARPENING * (4.0 * own - around);
}

fn coarse(source: texture_2d<f32>, texel: vec2f) -> vec4f {
  return textureSampleLevel(source, linear, 0.5 * texel / vec2f(textureDimensions(source)), 0.0);
}

@fragment fn settle_image(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  let place = vec2i(texel.xy);
  let d = textureLoad(image, place, 0).w;
  let share = coarser(diameter(d), LAST);
  let light = mix(sharper(image, place), coarse(coarse_image, texel.xy), share);
  return vec4f(light.xyz, d);
}

@fragment fn settle_sheet(@builtin(position) texel: vec4f) -> Sheet {
  let place = vec2i(texel.xy);
  let d = textureLoad(rim, place, 0).y;
  let share = coarser(diameter(d), LAST);
  let light = mix(sharper(image, place), coarse(coarse_image, texel.xy), share);
  let cover = mix(sharper(rim, place).x, coarse(coarse_rim, texel.xy).x, share);
  return Sheet(light, vec4f(cover, d, 0.0, 0.0));
}

// Where no disc is this level's own: the coarser level's answer, enlarged.
@fragment fn enlarge_image(@builtin(position) texel: vec4f) -> @location(0) vec4f {
  return coarse(coarse_image, texel.xy);
}

@fragment fn enlarge_sheet(@builtin(position) texel: vec4f) -> Sheet {
  return Sheet(coarse(coarse_image, texel.xy), coarse(coarse_rim, texel.xy));
}
