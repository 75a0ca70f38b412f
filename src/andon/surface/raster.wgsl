// Triangles into the G-buffer of a pinhole view.

//!import andon/gbuffer/gbuffer.wgsl
//!import andon/gbuffer/clip.wgsl
//!import andon/surface/plain.wgsl

@group(0) @binding(0) var<uniform> view: ViewRecord;
// Flags of the draw (valid, and object or not) in x; what is added to numbers of materials in y.
@group(0) @binding(1) var<uniform> draw_flags: vec4u;
// Diffuse reflectance of each material in xyz; texture layer in w, −1 for none.
@group(0) @binding(2) var<storage, read> materials: array<vec4f>;
@group(0) @binding(3) var textures: texture_2d_array<f32>;
@group(0) @binding(4) var base: texture_2d<u32>;

struct Corner {
  @builtin(position) clip: vec4f,
  @location(0) normal: vec3f,
  @location(1) uv: vec2f,
  @location(2) @interpolate(flat, first) material: vec4f,
  // Packed normal, reflectance and flags of the whole triangle.
  @location(3) @interpolate(flat, first) packed: vec3u,
};

fn pack_reflectance(reflectance: vec3f) -> u32 {
  return pack4x8unorm(vec4f(sqrt(clamp(reflectance, vec3f(0.0), vec3f(1.0))), 0.0));
}

// The octahedral map needs no unit vector.
fn towards(normal: vec3f, sight: vec3f) -> u32 {
  return octahedral_encode(select(normal, -normal, dot(normal, sight) > 0.0));
}

@vertex fn corner(
  @location(0) position: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) material: u32,
) -> Corner {
  let clip = clip_position(position);
  let look = materials[material];
  let flags = draw_flags.x | ((material + draw_flags.y) << MATERIAL_SHIFT);
  let sight = position - view.position;
  return Corner(clip, normal, uv, look, vec3u(towards(normal, sight), pack_reflectance(look.xyz), flags));
}

// A triangle of one normal and one colour: all is known at its first corner.
@fragment fn flat_surface(in: Corner) -> @location(0) vec4u {
  return vec4u(bitcast<u32>(1.0 / in.clip.w), in.packed);
}

@fragment fn surface(in: Corner) -> @location(0) vec4u {
  let sight = world_ray(in.clip.xy);
  return vec4u(
    bitcast<u32>(1.0 / in.clip.w),
    towards(in.normal, sight),
    pack_reflectance(base_colour(in.material, in.uv)),
    in.packed.z,
  );
}

// The base surface (a depth image, packed on the host) as background of virtual objects.
struct Background {
  @location(0) packed: vec4u,
  @builtin(frag_depth) depth: f32,
};

@fragment fn background(@builtin(position) pixel: vec4f) -> Background {
  let packed = textureLoad(base, vec2i(pixel.xy), 0);
  // Holes may have a cover, behind which nothing is drawn.
  let held = bitcast<f32>(packed.x);
  let depth = select(0.0, view.near_m / held, held > 0.0);
  return Background(packed, depth);
}
