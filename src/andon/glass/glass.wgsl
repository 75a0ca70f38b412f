// What one eye sees in glass, as three layers that are blurred afterwards: a view ray, its path
// through all solids, what it finds behind them, and how far away that appears.
//
// Lights are in units of the picture, premultiplied by coverage; blurs are diameters in pixels.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/glass/layers.wgsl
//!import andon/glass/silhouette.wgsl

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(0) @binding(2) var<uniform> solids: array<SolidRecord, 8>;
@group(0) @binding(3) var<uniform> glass: GlassRecord;
@group(0) @binding(4) var<uniform> highlights: array<HighlightRecord, 16>;
// Boxes and triangles of meshes (bvh.py).
@group(0) @binding(5) var nodes: texture_2d<f32>;
@group(0) @binding(6) var triangles: texture_2d<f32>;

struct Layers {
  // Light that comes through; a: blur.
  @location(0) refracted: vec4f,
  // Reflectance of what sticks to the glass times α; a: α.
  @location(1) surface: vec4f,
  // Light that is mirrored; a: blur.
  @location(2) reflected: vec4f,
  // Coverage, blur of the surface, flags, distance of the glass in metres.
  @location(3) sizes: vec4f,
};

// The polygon around all glass.
@vertex fn outline(@location(0) place: vec2f) -> @builtin(position) vec4f {
  return vec4f(place, 0.0, 1.0);
}

// What a pixel sees of the glass: the ray to trace for it, where that meets glass, and the share of
// the pixel that is glass, 0 where something nearer hides it.
struct Sight {
  ray: Ray,
  first: Boundary,
  coverage: f32,
};

// From the eye to the scene in metres, along the ray; a hole holds its cover's depth, or 0 where it is
// far away.
fn scene_distance(packed: vec4u, pixel: vec2f) -> f32 {
  let depth = bitcast<f32>(packed.x);
  let known = (packed.w & VALID) != 0u || depth > 0.0;
  return select(NOWHERE, depth * length(world_ray(pixel)), known);
}

fn sight(pixel: vec2f) -> Sight {
  let straight = Ray(view.position, normalize(world_ray(pixel)));
  let edge = silhouette(straight, sqrt(pixel_steradians(pixel)));
  let first = boundary(edge.ray, 0u);
  let behind = scene_distance(textureLoad(gbuffer, vec2i(pixel), 0), pixel);
  let seen = first.solid >= 0 && first.distance < behind;
  return Sight(edge.ray, first, select(0.0, edge.coverage, seen));
}

@fragment fn layers(@builtin(position) place: vec4f) -> Layers {
  let at = sight(place.xy);
  if at.coverage <= 0.0 {
    return Layers(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
  }
  let pixel_radians = sqrt(pixel_steradians(place.xy));
  let frame = frame_of(at.ray.direction);
  let start = start_pencil(frame.e1, frame.e2);
  let path = trace(at.ray, start, at.first, MIDDLE);
  let through = refracted_layer(at.ray, start, at.first, path, pixel_radians);
  let away = reflected_layer(at.ray, start, path, pixel_radians);
  let stuck = stuck_on(at.ray, start, at.first, pixel_radians);
  let lost = path.status == LOST;
  let own = select(through.flags, IS_LOST | (through.flags & ~IS_MISSED), lost);
  let flags = own | (away.flags & IS_CUT);
  let near = blur_px(vec4f(1.0, 0.0, 0.0, 1.0) / path.distance, path.distance, pixel_radians);
  return Layers(
    vec4f(through.light, through.blur_px) * at.coverage,
    stuck * at.coverage,
    vec4f(away.light, away.blur_px) * at.coverage,
    vec4f(at.coverage, near * at.coverage, f32(flags), path.distance),
  );
}

// The glass's own surface where something sticks to it, for the light that falls on it: a G-buffer,
// 0 elsewhere.
@fragment fn stickers(@builtin(position) place: vec4f) -> @location(0) vec4u {
  let at = sight(place.xy);
  let frame = frame_of(at.ray.direction);
  let start = start_pencil(frame.e1, frame.e2);
  let stuck = stuck_on(at.ray, start, at.first, sqrt(pixel_steradians(place.xy)));
  if at.coverage <= 0.0 || stuck.a <= 0.0 {
    return vec4u(0u);
  }
  let depth = at.first.distance / length(world_ray(place.xy));
  let root = sqrt(stuck.rgb / stuck.a);
  return vec4u(
    bitcast<u32>(depth), octahedral_encode(against(at.ray.direction, at.first.normal)),
    pack4x8unorm(vec4f(root, 0.0)), VALID | OBJECT,
  );
}
