// Visible lamps: discs of their own luminance, hidden by whatever is nearer (draw_lamps in
// reference.py). Drawn far to near over the picture, premultiplied.

//!import andon/gbuffer/gbuffer.wgsl
//!struct DiscRecord

@group(0) @binding(0) var gbuffer: texture_2d<u32>;
@group(0) @binding(1) var<uniform> view: ViewRecord;
@group(1) @binding(0) var<uniform> disc: DiscRecord;

struct DiscPictures {
  @location(0) luminance: vec4f,
  @location(1) bodies: vec4f,
};

@fragment fn lamp_disc(@builtin(position) pixel: vec4f) -> DiscPictures {
  let packed = textureLoad(gbuffer, vec2i(pixel.xy), 0);
  let ray = ray_planar(pixel.xy);
  // Of a hole: where its cover is.
  let held = bitcast<f32>(packed.x);
  let surface_m = select(1e30, held * length(ray), held > 0.0);
  let direction = normalize(world_ray(pixel.xy));
  let angle = 2.0 * asin(clamp(0.5 * length(direction - disc.direction), 0.0, 1.0));
  // Angle of a pixel, from its neighbour: the square root of its solid angle for square pixels.
  let along_x = normalize(ray_planar(pixel.xy + vec2f(0.5, 0.0)))
              - normalize(ray_planar(pixel.xy - vec2f(0.5, 0.0)));
  let along_y = normalize(ray_planar(pixel.xy + vec2f(0.0, 0.5)))
              - normalize(ray_planar(pixel.xy - vec2f(0.0, 0.5)));
  let pixel_angle = sqrt(max(length(cross(along_x, along_y)), 1e-16));
  let cover = clamp((disc.radius_radians - angle) / pixel_angle + 0.5, 0.0, 1.0);
  let seen = cover * select(0.0, 1.0, disc.distance_m < surface_m);
  let linear = vec4f(min(disc.linear, vec3f(65504.0)) * seen, seen);
  return DiscPictures(linear, linear);
}
