// Triangles into the G-buffer of a pinhole view.

//!import andon/gbuffer/gbuffer.wgsl

@group(0) @binding(0) var<uniform> view: ViewRecord;
// Flags of the draw (valid, and object or not) in x.
@group(0) @binding(1) var<uniform> draw_flags: vec4u;
// Diffuse reflectance of each material in xyz; texture layer in w, −1 for none.
@group(0) @binding(2) var<storage, read> materials: array<vec4f>;
@group(0) @binding(3) var textures: texture_2d_array<f32>;
@group(0) @binding(4) var base: texture_2d<u32>;

struct Corner {
  @builtin(position) clip: vec4f,
  @location(0) normal: vec3f,
  @location(1) uv: vec2f,
  @location(2) @interpolate(flat, first) material: u32,
};

@vertex fn corner(
  @location(0) position: vec3f,
  @location(1) normal: vec3f,
  @location(2) uv: vec2f,
  @location(3) material: u32,
) -> Corner {
  let p = (view.camera_from_world * vec4f(position, 1.0)).xyz;
  let image = (view.focal * p.xy + (view.centre - 0.5 * view.size) * p.z) * 2.0 / view.size;
  // Reversed infinite depth: near/z, so that float32 keeps its relative precision far away.
  return Corner(vec4f(image.x, -image.y, view.near_m, p.z), normal, uv, material);
}

@fragment fn surface(in: Corner) -> @location(0) vec4u {
  let depth = 1.0 / in.clip.w;
  let sight = world_direction(ray_planar(in.clip.xy));
  let normal = normalize(in.normal);
  let facing = select(normal, -normal, dot(normal, sight) > 0.0);
  let material = materials[in.material];
  var reflectance = material.xyz;
  if (material.w >= 0.0) { reflectance *= texel(in.uv, i32(material.w)); }
  return vec4u(
    bitcast<u32>(depth),
    octahedral_encode(facing),
    pack4x8unorm(vec4f(sqrt(clamp(reflectance, vec3f(0.0), vec3f(1.0))), 0.0)),
    draw_flags.x | (in.material << MATERIAL_SHIFT),
  );
}

// Bilinear and repeated, texel by texel, so that it agrees with the reference to the last bit that
// matters: a hardware sampler has 8-bit weights.
fn texel(uv: vec2f, layer: i32) -> vec3f {
  let size = vec2i(textureDimensions(textures));
  let p = uv * vec2f(size) - 0.5;
  let corner = vec2i(floor(p));
  let f = p - floor(p);
  let a = ((corner % size) + size) % size;
  let b = (a + 1) % size;
  let top = mix(textureLoad(textures, a, layer, 0), textureLoad(textures, vec2i(b.x, a.y), layer, 0), f.x);
  let low = mix(textureLoad(textures, vec2i(a.x, b.y), layer, 0), textureLoad(textures, b, layer, 0), f.x);
  return mix(top, low, f.y).xyz;
}

// The base surface (a depth image, packed on the host) as background of virtual objects.
struct Background {
  @location(0) packed: vec4u,
  @builtin(frag_depth) depth: f32,
};

@fragment fn background(@builtin(position) pixel: vec4f) -> Background {
  let packed = textureLoad(base, vec2i(pixel.xy), 0);
  let depth = select(0.0, view.near_m / bitcast<f32>(packed.x), (packed.w & VALID) != 0u);
  return Background(packed, depth);
}
