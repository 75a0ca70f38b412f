// Light of lamps beside and through glass balls: the same functions as reference.py here.

//!struct BallRecord

@group(1) @binding(10) var<uniform> balls: array<BallRecord, 64>;
// E·ρ²/E_centre and its lean, in units of LIGHT_SCALE; a layer for each lamp and ball.
@group(1) @binding(11) var ball_tables: texture_2d_array<f32>;

//!import andon/transport/direct/balls/pairs.wgsl

struct Straight {
  position: vec3f,
  normal: vec3f,
  free: f32,
  lit: f32,
  seen: f32,
  relative: f32,
};

const STEEPEST: f32 = 30.0;
const LEAST_LIGHT: f32 = 1e-5;

// Receiver relative to a ball, in radii.
struct BallPlace {
  along: f32,
  off: f32,
  outwards: vec3f,
  radial: vec3f,
  vergence: f32,
};

fn ball_place(pair: i32, position: vec3f) -> BallPlace {
  let ball = balls[pair];
  let offset = (position - ball.centre) / ball.radius_m;
  let along = dot(offset, ball.axis);
  let across = offset - along * ball.axis;
  let off = length(across);
  let vergence = 1.0 / max(length(offset), 1e-9);
  return BallPlace(along, off, across / max(off, 1e-9), offset * vergence, vergence);
}

// Does the straight line to the lamp pass beside the ball? In radii the lamp is at −1/lamp_vergence;
// P hides behind the tangent point, or is inside.
fn is_open(pair: i32, at: BallPlace) -> bool {
  let lamp_vergence = balls[pair].lamp_vergence;
  let ahead = 1.0 + at.along * lamp_vergence;
  let square = at.off * at.off;
  let behind = at.along * ahead + square * lamp_vergence > 0.0 && ahead > 0.0;
  let near = square * (1.0 - lamp_vergence * lamp_vergence) < ahead * ahead;
  return !(at.vergence > 1.0 || (behind && near));
}

// Does a ray enter a ball in front of `within` metres, or start inside it?
fn meets(origin: vec3f, direction: vec3f, pair: i32, within: f32) -> bool {
  let offset = (balls[pair].centre - origin) / balls[pair].radius_m;
  let along = dot(offset, direction);
  let square = dot(offset, offset);
  let ahead = along > 0.0 && along * balls[pair].radius_m < within;
  return square < 1.0 || (ahead && square - along * along < 1.0);
}

fn table_texel(layer: i32, row: i32, column: i32) -> vec4f {
  return textureLoad(ball_tables, vec2i(column, row), layer, 0);
}

fn looked_up(layer: i32, at: BallPlace) -> vec4f {
  // sin ψ/2 without a difference of near numbers ahead.
  let distance = 1.0 / at.vergence;
  let behind = sqrt(clamp((1.0 - at.along * at.vergence) * 0.5, 0.0, 1.0));
  let before = at.off * inverseSqrt(max(2.0 * distance * (distance + at.along), 1e-12));
  let sine = select(behind, before, at.along > 0.0);
  let place = (1.0 + KNEE) * sine / (KNEE + sine);
  let column = clamp(place * f32(CELLS) - 0.5, 0.0, f32(CELLS - 1));
  let row = clamp(at.vergence, 0.0, 1.0) * f32(ROWS - 1);
  let left = min(i32(column), CELLS - 2);
  let upper = min(i32(row), ROWS - 2);
  let share = vec2f(column - f32(left), row - f32(upper));
  let first = mix(table_texel(layer, upper, left), table_texel(layer, upper, left + 1), share.x);
  let second =
    mix(table_texel(layer, upper + 1, left), table_texel(layer, upper + 1, left + 1), share.x);
  return mix(first, second, share.y);
}

// Light that ball `pair` sends to `at`, over the light of the lamp (its intensity, or illuminance).
fn refracted(lamp: i32, pair: i32, pairs: vec2i, at: BallPlace, line: Straight) -> vec3f {
  let ball = balls[pair];
  let found = looked_up(pair, at);
  let tilt = found.w / max(found.x + found.y + found.z, LEAST_LIGHT / LIGHT_SCALE);
  let slope = clamp(tilt * at.vergence, -STEEPEST, STEEPEST);
  let cosine = inverseSqrt(1.0 + slope * slope);
  let across = (at.along * at.outwards - at.off * ball.axis) * at.vergence;
  let leaning = at.radial - across * slope;
  let facing = max(-dot(leaning, line.normal), 0.0);
  let arriving = leaning * cosine;
  // Where it comes from: the ray of the same impact parameter.
  let lamp_sine = clamp(tilt * cosine, -1.0, 1.0) * ball.lamp_vergence;
  let leaving = ball.axis * sqrt(1.0 - lamp_sine * lamp_sine) + at.outwards * lamp_sine;
  var light = found.xyz * (LIGHT_SCALE * facing * at.vergence * at.vergence * ball.at_centre);
  light *= emitted_share(lamp, leaving);
  for (var other = pairs.x; other < pairs.y; other++) {
    if (other != pair && balls[other].radius_m > 0.0) {
      let taken = meets(line.position, -arriving, other, ball.radius_m / at.vergence);
      // From a lamp with a place along the ray; parallel light: back from the ball's centre.
      let start = select(ball.centre, lamps[lamp].position, ball.lamp_distance_m > 0.0);
      let towards = select(-ball.axis, leaving, ball.lamp_distance_m > 0.0);
      let reach = select(1e30, ball.lamp_distance_m, ball.lamp_distance_m > 0.0);
      let dimmed = select(vec3f(1.0), balls[other].straight, meets(start, towards, other, reach));
      light *= dimmed * select(1.0, 0.0, taken);
    }
  }
  return light;
}

fn received(lamp: i32, line: Straight) -> vec3f {
  let pairs = pairs_of(lamp);
  var straight = line.free * line.lit * line.relative;
  var bent = vec3f(0.0);
  for (var pair = pairs.x; pair < pairs.y; pair++) {
    if (balls[pair].radius_m > 0.0) {
      let at = ball_place(pair, line.position);
      straight = select(0.0, straight, is_open(pair, at));
      bent += refracted(lamp, pair, pairs, at, line);
    }
  }
  // Where the lamp does not shine by itself, there is no line to it that could be hidden.
  let seen = select(1.0, line.seen, line.free > 0.0 && line.relative > 0.0);
  return lamps[lamp].light * (straight + bent * seen);
}
