// Base colour of materials of which some have a texture: layer in w, −1 for none.

// Bilinear and repeated, texel by texel, so that it agrees with the reference: a hardware sampler has 8-bit weights.
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

fn base_colour(material: vec4f, uv: vec2f) -> vec3f {
  let colour = texel(uv, max(i32(material.w), 0));
  return material.xyz * select(vec3f(1.0), colour, material.w >= 0.0);
}
