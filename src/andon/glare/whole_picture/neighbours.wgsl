// Light between a pixel and its eight neighbours.

//!import andon/glare/whole_picture/usable.wgsl

@group(0) @binding(0) var picture: texture_2d<f32>;
// What a pixel exchanges with the one beside it, below, and to both sides of that; 0 where none is.
@group(0) @binding(1) var exchanged: texture_2d<f32>;
// What arrives of it (x), and the share of a pixel's light that leaves it so (y).
@group(0) @binding(2) var factors: texture_2d<f32>;

const DIRECTIONS = array(vec2i(1, 0), vec2i(0, 1), vec2i(1, 1), vec2i(-1, 1));

// What comes round the border is exchanged with nothing, but for the columns of a panorama.
fn around(at: vec2i) -> vec2i {
  let size = vec2i(textureDimensions(picture));
  return (at + size) % size;
}

fn light_at(at: vec2i) -> vec3f {
  return usable(textureLoad(picture, at, 0).xyz);
}

fn from_neighbours(place: vec2i) -> vec3f {
  let own = textureLoad(exchanged, place, 0);
  var sum = vec3f(0.0);
  for (var i = 0; i < 4; i++) {
    let one = around(place + DIRECTIONS[i]);
    let other = around(place - DIRECTIONS[i]);
    sum += own[i] * light_at(one) + textureLoad(exchanged, other, 0)[i] * light_at(other);
  }
  return sum;
}

// What is added alone.
@fragment fn added(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  return vec4f(from_neighbours(place) * textureLoad(factors, place, 0).x, 0.0);
}

// And less what leaves.
@fragment fn passed(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
  let place = vec2i(pixel.xy);
  let factor = textureLoad(factors, place, 0).xy;
  return vec4f(from_neighbours(place) * factor.x - factor.y * light_at(place), 0.0);
}
