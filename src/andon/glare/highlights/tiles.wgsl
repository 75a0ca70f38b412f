// Sums over tiles of SIDE × SIDE pixels: survey_tiles and light_tiles of tiles.py.

//!import andon/gbuffer/view.wgsl
//!import andon/glare/highlights/frames.wgsl
//!struct TileRecord

@group(0) @binding(0) var highlights: texture_2d<f32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var<uniform> settings: TileRecord;
@group(0) @binding(3) var luminance: texture_2d<f32>;

const SIDE: i32 = 8;
const WEIGHTS: vec3f = vec3f(0.2126, 0.7152, 0.0722);

fn direction_at(pixel: vec2i) -> vec3f {
  return normalize(world_ray(vec2f(pixel) + 0.5));
}

fn solid_angle(pixel: vec2i) -> f32 {
  let middle = vec2f(pixel) + 0.5;
  let across = normalize(world_ray(middle + vec2f(0.5, 0.0))) - normalize(world_ray(middle - vec2f(0.5, 0.0)));
  let down = normalize(world_ray(middle + vec2f(0.0, 0.5))) - normalize(world_ray(middle - vec2f(0.0, 0.5)));
  return length(cross(across, down));
}

// The brightest highlight, Σ Y·ω of the rest of the picture, and Σ ω.
@fragment fn survey(@builtin(position) tile: vec4f) -> @location(0) vec4f {
  let size = vec2i(view.size);
  var found = vec3f(0.0);
  for (var i = 0; i < SIDE * SIDE; i++) {
    let pixel = vec2i(tile.xy) * SIDE + vec2i(i % SIDE, i / SIDE);
    let inside = select(0.0, 1.0, all(pixel < size));
    let value = dot(textureLoad(highlights, pixel, 0).xyz, WEIGHTS) * inside;
    let whole = dot(textureLoad(luminance, pixel, 0).xyz, WEIGHTS) * settings.cd_m2_per_unit;
    let omega = solid_angle(pixel) * inside;
    found = vec3f(max(found.x, value), found.yz + vec2f(max(whole - value, 0.0), 1.0) * omega);
  }
  return vec4f(found, 0.0);
}

struct Light {
  @location(0) illuminance: vec4f,
  @location(1) squares: vec4f,
};

// Σ L·ω and Σ Y·ω·x; then Σ Y·ω·(y, x² + ω/12, y² + ω/12, xy).
@fragment fn light(@builtin(position) tile: vec4f) -> Light {
  let size = vec2i(view.size);
  let corner = vec2i(tile.xy) * SIDE;
  let middle = direction_at(min(corner + SIDE / 2, size - 1));
  let a = first_of_frame(middle);
  let b = second_of_frame(middle);
  var found = Light(vec4f(0.0), vec4f(0.0));
  for (var i = 0; i < SIDE * SIDE; i++) {
    let pixel = corner + vec2i(i % SIDE, i / SIDE);
    let lit = textureLoad(highlights, pixel, 0).xyz * select(0.0, 1.0, all(pixel < size));
    let value = dot(lit, WEIGHTS);
    let step = clamp(value / settings.threshold_cd_m2 - 0.5, 0.0, 1.0);
    let omega = solid_angle(pixel);
    let kept = omega * step * step * (3.0 - 2.0 * step);
    // A difference of directions holds more digits than its components on the tangents.
    let off = direction_at(pixel) - middle;
    let x = dot(off, a);
    let y = dot(off, b);
    found.illuminance += vec4f(lit * kept, value * kept * x);
    found.squares += value * kept * vec4f(y, x * x + omega / 12.0, y * y + omega / 12.0, x * y);
  }
  return found;
}
