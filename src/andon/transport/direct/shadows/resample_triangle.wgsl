// What a disc holds: the number of the triangle that is seen, plus one; 0 is nothing. Float32 counts
// exactly to 16.7 million.

fn choose(direction: vec3f, near: vec2i, across: vec2i, down: vec2i, opposite: vec2i) -> f32 {
  return textureLoad(faces, near, 0).w;
}
