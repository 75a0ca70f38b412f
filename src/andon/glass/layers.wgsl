// The layers of one pixel: light, and how much it is blurred. The shader that imports this declares
// `glass` and `highlights`.

//!struct GlassRecord
//!struct HighlightRecord
//!import andon/gpu/pi.wgsl
//!import andon/glass/paths.wgsl
//!import andon/glass/backdrops/which.wgsl
//!import andon/glass/backdrops/environment.wgsl
//!import andon/glass/backdrops/sticker.wgsl

// Channel whose rays say how far away things appear: green.
const MIDDLE: i32 = 1;

const IS_LOST: u32 = 1u;
// No backdrop there: the light of the environment.
const IS_MISSED: u32 = 2u;
// A blur was cut.
const IS_CUT: u32 = 4u;
// A backdrop that is not in the frame.
const IS_BESIDE: u32 = 8u;

struct Layer {
  light: vec3f,
  blur_px: f32,
  flags: u32,
};

// What pencils move by for a step of one pixel.
fn footprint_of(p: Pencil, pixel_radians: f32) -> Footprint {
  return Footprint(
    mat2x3f(p.place[2], p.place[3]) * pixel_radians, mat2x3f(p.course[2], p.course[3]) * pixel_radians,
  );
}

// Of the vergence V, or of what is `distance` metres from the eye, as the settings say.
fn blur_px(V: vec4f, distance: f32, pixel_radians: f32) -> f32 {
  let own = select(vec4f(1.0, 0.0, 0.0, 1.0) / distance, V, glass.apparent != 0u);
  return min(blur_radians(own, glass.focus_dioptres, glass.pupil_m) / pixel_radians, glass.largest_px);
}

// What a ray finds behind its last boundary; misses see the environment.
fn found(solid: i32, ray: Ray, p: Pencil, eye: vec3f, pixel_radians: f32) -> Layer {
  let seen = backdrop_seen(solid, ray.origin, ray.direction, footprint_of(p, pixel_radians));
  let light = select(seen.light, environment_light(solid, ray.direction), seen.missed);
  let V = vergence(spread_at(p, ray.direction, seen.distance));
  let blur = blur_px(V, length(ray.origin + seen.distance * ray.direction - eye), pixel_radians);
  let cut = blur >= glass.largest_px && glass.pupil_m > 0.0;
  let flags = select(0u, IS_MISSED, seen.missed) | select(0u, IS_BESIDE, seen.beside);
  return Layer(light, blur, flags | select(0u, IS_CUT, cut));
}

fn found_through(ray: Ray, path: Path, pixel_radians: f32) -> Layer {
  var layer = found(row_of(path.solid), path.exit, path.pencil, ray.origin, pixel_radians);
  layer.light *= path.transmitted * path.inside;
  return layer;
}

// `path` is that of the middle channel.
fn refracted_layer(ray: Ray, start: Pencil, first: Boundary, path: Path, pixel_radians: f32) -> Layer {
  var layer = found_through(ray, path, pixel_radians);
  if DISPERSES {
    let red = found_through(ray, trace(ray, start, first, 0), pixel_radians);
    let blue = found_through(ray, trace(ray, start, first, 2), pixel_radians);
    layer.light = vec3f(red.light.r, layer.light.g, blue.light.b);
  }
  return layer;
}

// Lamps as Phong's lobe, energy kept: E·(m + 1)/(2π)·cosᵐ of the angle from the mirrored ray.
fn highlight_light(solid: i32, point: vec3f, direction: vec3f) -> vec3f {
  let exponent = solids[solid].highlight_exponent;
  var light = vec3f(0.0);
  for (var i = 0u; i < glass.highlights; i++) {
    if SOLIDS > 1 && highlights[i].solid != solid { continue; }
    let place = highlights[i].place;
    let reach = place.xyz - point * place.w;
    let square = dot(reach, reach);
    let cosine = max(dot(direction, reach) * inverseSqrt(square), 0.0);
    let lux = highlights[i].light / select(1.0, square, place.w > 0.0);
    light += lux * ((exponent + 1.0) / (2.0 * PI) * pow(cosine, exponent));
  }
  return light * glass.units_per_cd_m2;
}

fn reflected_layer(ray: Ray, start: Pencil, path: Path, pixel_radians: f32) -> Layer {
  let away = mirror(ray, start, path);
  var layer = found(row_of(path.solid), away.ray, away.pencil, ray.origin, pixel_radians);
  layer.light += highlight_light(row_of(path.solid), path.point, away.ray.direction);
  layer.light *= path.reflectance;
  return layer;
}

// What sticks to the glass: reflectance times α, and α.
fn stuck_on(ray: Ray, start: Pencil, first: Boundary, pixel_radians: f32) -> vec4f {
  if !STICKERS {
    return vec4f(0.0);
  }
  let solid = row_of(first.solid);
  let on = transferred(start, first.distance, ray.direction, first.facet);
  let moves = mat2x3f(on.place[2], on.place[3]) * pixel_radians;
  let at = sticking(first, ray.origin + first.distance * ray.direction, moves);
  let stuck = sticker_at(solid, at.uv, at.steps) * solids[solid].sticker_alpha;
  return select(vec4f(0.0), stuck, at.uv.x >= 0.0);
}
