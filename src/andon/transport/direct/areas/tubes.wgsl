// The capsule: two arcs and two lines, one closure. Frame (d, g, m) and letters of the reference:
// d along the axis, g from the receiver to the axis, rho away; the ends at along and along + length.

//!import andon/transport/direct/areas/angles.wgsl

struct TubeView {
  n: vec3f,        // the receiver's normal
  ahead: vec3f,    // on the horizon towards the tube's middle, unit
  aside: vec3f,    // perpendicular to it on the horizon
  middle: vec2f,   // the tube's middle along these
  r: f32,
  rho: f32,
  lean: f32,       // sin and cos of the tangent planes' tilt
  spread: f32,
};

struct TubePiece { value: f32, turn: vec2f };

fn turned(p: vec2f, q: vec2f) -> vec2f {
  return vec2f(p.x * q.x - p.y * q.y, fma(p.x, q.y, p.y * q.x));
}

// Where `offset` from the tube's middle is seen on the horizon; 1 where it is not `there`.
fn tube_azimuth(view: TubeView, offset: vec3f, there: bool) -> vec2f {
  let place = view.middle + vec2f(dot(view.ahead, offset), dot(view.aside, offset));
  return select(vec2f(1.0, 0.0), place, there);
}

// The line on one side. `heights` of its two points of contact, in the order of the ends.
fn tube_line(view: TubeView, along: f32, span: f32, heights: vec2f, side: f32) -> TubePiece {
  let above = heights > vec2f(0.0);
  let drop = heights.x - heights.y;
  let at = clamp(heights.x / select(1.0, drop, abs(drop) > TINY), 0.0, 1.0);
  let start = select(at, 0.0, above.x);
  let end = select(at, 1.0, above.y);
  let reach = select(0.0, (end - start) * span, any(above));
  let square = max((view.rho - view.r) * (view.rho + view.r), 0.0);
  let angle = angle_of(sqrt(square) * reach, square + fma(start, span, along) * fma(end, span, along));
  let value = -0.5 * angle * (side * view.spread * view.n.z - view.lean * view.n.y);
  let offset = vec3f((at - 0.5) * span, -view.r * view.lean, side * view.r * view.spread);
  let crossing = tube_azimuth(view, offset, above.x != above.y);
  let enters = select(above.x, above.y, side > 0.0);
  return TubePiece(value, crossing * vec2f(1.0, select(-1.0, 1.0, enters)));
}

// The arc around the end at `along`, `middle` = its place from the tube's middle. `side` −1: first
// end. `above`: whether its first and its last point are above the horizon, as the lines see it.
fn tube_arc(view: TubeView, along: f32, middle: f32, above: vec2<bool>, side: f32) -> TubePiece {
  let r = view.r;
  let square = fma(along, along, view.rho * view.rho);
  let inverse = inverseSqrt(max(square, TINY));
  let gap = square * inverse - r;
  let root = sqrt(max(gap * (gap + 2.0 * r), 0.0));
  // half the arc's width about o, away from the other end
  let opening = vec2f(side * r * along / max(view.rho, r), square * inverse * view.spread);
  let arc_w = opening * inverseSqrt(max(dot(opening, opening), TINY));
  let w = angle_of(opening.y, opening.x);
  let o = vec2f(side * view.rho, -side * along) * inverse;
  let tilt = vec2f(dot(view.n.xy, o), -side * view.n.z);
  let steep = length(tilt);
  let top = select(vec2f(1.0, 0.0), tilt / max(steep, TINY), steep > TINY);
  let centre = fma(along, view.n.x, view.rho * view.n.y) * inverse;
  let level = centre * root;
  let crossed = abs(level) < r * steep;
  let cosine = clamp(-level / max(r * steep, TINY), -1.0, 1.0);
  let sine = sqrt((1.0 - cosine) * (1.0 + cosine));
  let rise = angle_of_cosine(cosine);
  // Mirrored so that the arc's middle is at or after the top: it can dip once on the far side only.
  let turn = angle_of(abs(top.y), top.x);
  let t1 = turn - w;
  let t2 = turn + w;
  let mixed = vec2f(abs(top.y) * arc_w.x, top.x * arc_w.y);
  let sin1 = mixed.x - mixed.y;
  let sin2 = mixed.x + mixed.y;
  let low = max(t1, -rise);
  let high = min(t2, rise);
  let again = t2 - (2.0 * PI - rise);
  let sines = select(0.0, select(sin2, sine, t2 > rise) - select(sin1, -sine, t1 < -rise), high > low)
    + select(0.0, sin2 + sine, again > 0.0);
  let angles = max(high - low, 0.0) + max(again, 0.0);
  let value = 0.5 * r * inverse * inverse * (r * centre * angles - root * steep * sines);

  let towards = select(tilt.x, -tilt.x, above.x) > arc_w.x * steep;
  let twice = above.x == above.y && towards && crossed;
  // leaving at top + rise, entering at top − rise
  let shrink = -r * r * inverse * inverse;
  let base = vec3f(fma(shrink, along, middle), shrink * view.rho, 0.0);
  let size = r * root * inverse;
  let along_o = vec3f(o, 0.0) * (size * top.x * cosine);
  let along_m = vec3f(0.0, 0.0, -side * size * top.y * cosine);
  let swing = size * sine * vec3f(-o * top.y, -side * top.x);
  let mid = base + along_o + along_m;
  let leaving = tube_azimuth(view, mid + swing, twice || (above.x && !above.y));
  let entering = tube_azimuth(view, mid - swing, twice || (above.y && !above.x));
  return TubePiece(value, turned(leaving * vec2f(1.0, -1.0), entering));
}

// `a`, `b`: ends − receiver; they may coincide. At or inside the surface: as on it.
fn tube_factor(a: vec3f, b: vec3f, normal: vec3f, radius: f32) -> f32 {
  let line = b - a;
  let span = length(line);
  let d = select(vec3f(1.0, 0.0, 0.0), line / max(span, TINY), span > TINY);
  let along = dot(a, d);
  let across = a - along * d;
  let distance = length(across);
  let helper = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(d.x) < 0.6);
  let g = select(normalize(cross(d, helper)), across / max(distance, TINY), distance > 1e-6 * abs(along));
  let n = vec3f(dot(normal, d), dot(normal, g), dot(normal, cross(d, g)));
  let nearest = clamp(0.0, along, along + span);
  let square = fma(nearest, nearest, distance * distance);
  let outside = square > radius * radius;
  let rho = select(2.0 * radius, distance, outside);

  let lean = radius / max(rho, radius);
  let spread = sqrt(max((rho - radius) * (rho + radius), 0.0)) / max(rho, radius);
  let centre = vec3f(fma(0.5, span, along), rho, 0.0);
  let helper_n = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(n.x) < 0.6);
  let beside = cross(n, centre);
  let is_beside = dot(beside, beside) > 1e-4 * dot(centre, centre);
  let aside = normalize(select(cross(n, helper_n), beside, is_beside));
  let ahead = cross(aside, n);
  let middle = vec2f(dot(ahead, centre), select(dot(aside, centre), 0.0, is_beside));
  let view = TubeView(n, ahead, aside, middle, radius, rho, lean, spread);

  // Heights of the four points of contact: ends in x, y; sides + and −.
  let axis = vec2f(along, along + span) * n.x + (rho - radius * lean) * n.y;
  let plus = axis + radius * spread * n.z;
  let minus = axis - radius * spread * n.z;
  let first = tube_arc(view, along, -0.5 * span, vec2<bool>(minus.x > 0.0, plus.x > 0.0), -1.0);
  let second = tube_arc(view, along + span, 0.5 * span, vec2<bool>(plus.y > 0.0, minus.y > 0.0), 1.0);
  let upper = tube_line(view, along, span, plus, 1.0);
  let lower = tube_line(view, along, span, minus, -1.0);
  let turn = turned(turned(first.turn, second.turn), turned(upper.turn, lower.turn));
  let factor = first.value + second.value + upper.value + lower.value + 0.5 * angle_of(turn.y, turn.x);
  let inward = fma(nearest, n.x, distance * n.y) * inverseSqrt(max(square, TINY));
  return select(0.5 * PI * (1.0 + inward), clamp(factor, 0.0, PI), outside);
}
