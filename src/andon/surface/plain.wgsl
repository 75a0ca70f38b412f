// Base colour of materials without a texture.

fn base_colour(material: vec4f, uv: vec2f) -> vec3f {
  return material.xyz;
}
