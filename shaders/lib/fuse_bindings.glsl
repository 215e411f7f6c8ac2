// Shared by the passes of fusion: the frame maps, the map, and the measurement at a pixel.
#include "shaders/lib/blocks.glsl"
#include "shaders/lib/surface_point.glsl"
#include "shaders/lib/parameters.glsl"
TEXELS(0, raw_depth_m);
TEXELS(1, frame_points);
TEXELS(2, frame_color);
layout(scalar, binding = 3) buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 4) buffer Attributes { SurfelAttributes attributes[]; };
layout(scalar, binding = 5) buffer Times { uvec2 times[]; };
TEXELS(6, camera_from_submap);
// By pixel: a cell of the index map, kNew, or HERMITE_NONE if there is nothing to fuse.
layout(scalar, binding = 7) buffer Candidates { uint candidates[]; };
layout(scalar, binding = 8) buffer Tiles { uint new_by_group[]; };
layout(scalar, binding = 9) buffer State { MapState state; };
PARAMETERS(FuseParams, p);

const uint kNew = 0xfffffffeu;  // a surface that is not yet in the map
// Bits of a claim for the pixel: 2048 x 2048 pixels; the distance takes the remaining bits.
const uint kPixelBits = 22u;

struct Measurement {
  vec3 position;  // camera frame
  vec3 normal;
  float radius_m;
  vec2 curvatures;
  vec3 color;
  float confidence;
};

// Each workgroup processes one tile of the image.
uint pixel_index() {
  uvec2 pixel = pixel_in_tile(p.camera, gl_WorkGroupID.x, gl_LocalInvocationID.x);
  return pixel.x < p.camera.width && pixel.y < p.camera.height ? pixel.y * p.camera.width + pixel.x
                                                               : HERMITE_NONE;
}
ivec2 pixel_of(uint i) { return ivec2(i % p.camera.width, i / p.camera.width); }

float fused_depth_m(SurfacePoint point, uint i) {
  return p.fuse_surface != 0u ? point.depth_m : float_at(raw_depth_m, i);
}

// A surfel without confidence would be counted, although its slot counts as free.
bool can_be_fused(SurfacePoint point, uint i) {
  return point.depth_m > 0.0 && float_at(raw_depth_m, i) > 0.0 && point.weight > 0.0;
}

Measurement measure(uint i) {
  SurfacePoint point = point_at(frame_points, i);
  vec3 normal = unpack_normal(point.normal);
  uint c = uint_at(frame_color, i);
  return Measurement(
      pixel_ray(p.camera, vec2(pixel_of(i))) * fused_depth_m(point, i), normal,
      support_radius(p.camera, p.radius_scale, point.depth_m, normal.z),
      unpackHalf2x16(point.curvatures),
      clamp((vec3(c & 255u, (c >> 8) & 255u, (c >> 16) & 255u) - p.offset) / p.gain, 0.0, 255.0),
      point.weight);
}
