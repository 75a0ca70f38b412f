// Pixels of a finish as their lobes see them: the same functions as facets.py, in float32.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/glare/highlights/frames.wgsl
//!import andon/glare/highlights/waves.wgsl
//!struct FinishRecord

@group(3) @binding(0) var<storage, read> finishes: array<FinishRecord>;

const PHONG: u32 = 2u;
const WATER: u32 = 3u;
const DIELECTRIC: f32 = 0.04;
const LEAST_VIEW: f32 = 0.02;
const SAME_SURFACE: f32 = 0.05;

struct Facet {
  kind: u32,
  position: vec3f,
  ground: vec3f,
  normal: vec3f,
  view: vec3f,
  tangent: vec3f,
  along: vec3f,
  // The view and the mirrored view: the latter in the world.
  local_view: vec3f,
  mirror: vec3f,
  alpha: vec2f,
  straight: vec3f,
  metallic: f32,
  exponent: f32,
  ratio: f32,
};

fn brushed(normal: vec3f, finish: FinishRecord) -> vec3f {
  let wanted = select(finish.axis, cross(finish.axis, normal), finish.around > 0.5);
  let along = wanted - dot(wanted, normal) * normal;
  let reach = length(along);
  return select(second_of_frame(normal), along / max(reach, 1e-6), reach > 1e-6);
}

// Squared turn of the normal to a neighbour of the same surface; 1e30 elsewhere.
fn turn_to(here: vec4u, normal: vec3f, pixel: vec2i) -> f32 {
  let size = vec2i(view.size);
  let inside = all(pixel >= vec2i(0)) && all(pixel < size);
  let there = textureLoad(gbuffer, clamp(pixel, vec2i(0), size - 1), 0);
  let depth = bitcast<f32>(here.x);
  let same = inside && there.w == here.w && abs(bitcast<f32>(there.x) - depth) <= SAME_SURFACE * depth;
  let turn = octahedral_decode(there.y) - normal;
  return select(1e30, dot(turn, turn), same);
}

fn curvature(here: vec4u, normal: vec3f, pixel: vec2i) -> f32 {
  let column = min(turn_to(here, normal, pixel + vec2i(1, 0)), turn_to(here, normal, pixel - vec2i(1, 0)));
  let row = min(turn_to(here, normal, pixel + vec2i(0, 1)), turn_to(here, normal, pixel - vec2i(0, 1)));
  return (select(0.0, column, column < 1e29) + select(0.0, row, row < 1e29)) * (2.0 / 12.0);
}

// What a step of one pixel along `step` moves a point on its plane by.
fn footprint(point: SurfacePoint, pixel: vec2f, step: vec2f) -> vec3f {
  let ray = world_ray(pixel);
  let turn = world_ray(pixel + 0.5 * step) - world_ray(pixel - 0.5 * step);
  let fall = dot(ray, point.normal);
  let safe = select(1e-9, fall, abs(fall) > 1e-9);
  let away = dot(point.position - view.position, point.normal);
  return away / safe * (turn - dot(turn, point.normal) / safe * ray);
}

fn facet_at(point: SurfacePoint, here: vec4u, pixel: vec2f) -> Facet {
  let finish = finishes[min((point.flags >> MATERIAL_SHIFT) & 0xffffu, arrayLength(&finishes) - 1u)];
  let own = (point.flags & OBJECT) != 0u && (point.flags >> BODY_SHIFT) == 0u;
  var facet: Facet;
  facet.kind = select(0u, u32(finish.kind), own && (point.flags & VALID) != 0u);
  facet.position = point.position;
  facet.ground = point.normal;
  facet.view = normalize(view.position - point.position);
  var widening = 0.0;
  var normal = point.normal;
  if (facet.kind == WATER) {
    let steps = array<vec3f, 2>(
      footprint(point, pixel, vec2f(1.0, 0.0)), footprint(point, pixel, vec2f(0.0, 1.0)),
    );
    let slopes = slopes_at(vec2u(u32(finish.first_wave), u32(finish.waves)), point.position, steps);
    let side = select(1.0, -1.0, point.normal.y < 0.0);
    normal = normalize(normal - side * vec3f(slopes.x, 0.0, slopes.y));
    widening = slopes.z;
  } else {
    widening = curvature(here, point.normal, vec2i(pixel));
  }
  normal = normalize(normal + max(LEAST_VIEW - dot(normal, facet.view), 0.0) * facet.view);
  facet.normal = normal;
  let has_axis = dot(finish.axis, finish.axis) > 0.0;
  facet.along = select(second_of_frame(normal), brushed(normal, finish), has_axis);
  facet.tangent = cross(facet.along, normal);
  facet.local_view = local(facet, facet.view);
  facet.mirror = 2.0 * dot(normal, facet.view) * normal - facet.view;
  facet.alpha = sqrt(finish.alpha * finish.alpha + widening);
  let mixed = mix(vec3f(DIELECTRIC), point.reflectance, finish.metallic);
  facet.straight = select(mixed, finish.straight, finish.straight.x >= 0.0);
  facet.metallic = finish.metallic;
  facet.exponent = finish.exponent;
  facet.ratio = select(finish.index, 1.0 / finish.index, facet.view.y < 0.0);
  return facet;
}

fn local(facet: Facet, direction: vec3f) -> vec3f {
  return vec3f(dot(direction, facet.tangent), dot(direction, facet.along), dot(direction, facet.normal));
}
