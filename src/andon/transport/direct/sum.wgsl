// All lamps of a frame, group by group. The stage exchanges this module for one that names the
// frame's own lamps: a software rasteriser runs through a loop once even if it is empty.

const MAP_SIZE: f32 = 1024.0;
const TRIANGLES: i32 = 1;

fn illuminance(position: vec3f, normal: vec3f, bias: f32) -> vec3f {
  var total = vec3f(0.0);
  var lamp = 0;
  var end = i32(direct.points);
  for (; lamp < end; lamp++) { total += point_illuminance(lamp, lamps[lamp].shadow_layer, position, normal, bias); }
  end += i32(direct.wide_spots);
  for (; lamp < end; lamp++) { total += wide_spot_illuminance(lamp, lamps[lamp].shadow_layer, position, normal, bias); }
  end += i32(direct.spots);
  for (; lamp < end; lamp++) { total += spot_illuminance(lamp, lamps[lamp].shadow_layer, position, normal, bias); }
  end += i32(direct.directionals);
  for (; lamp < end; lamp++) { total += directional_illuminance(lamp, lamps[lamp].shadow_layer, position, normal, bias); }
  end += i32(direct.hemispheres);
  for (; lamp < end; lamp++) { total += hemisphere_illuminance(lamp, normal); }
  return total;
}
