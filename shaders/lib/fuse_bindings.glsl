// What the passes of fusion share: the frame maps, the map, and the measurement at a pixel.
layout(scalar, binding = 0) readonly buffer RawDepth { float raw_depth_m[]; };
layout(scalar, binding = 1) readonly buffer SurfaceDepth { float surface_depth_m[]; };
layout(scalar, binding = 2) readonly buffer FrameNormals { uint frame_normals[]; };
layout(scalar, binding = 3) readonly buffer FrameCurvatures { uint frame_curvatures[]; };
layout(scalar, binding = 4) readonly buffer FrameConfidence { float frame_confidence[]; };
layout(scalar, binding = 5) readonly buffer FrameColor { uint frame_color[]; };
layout(scalar, binding = 6) buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 7) buffer Attributes { SurfelAttributes attributes[]; };
layout(scalar, binding = 8) buffer Times { uvec2 times[]; };
layout(scalar, binding = 9) readonly buffer Submaps { Transform camera_from_submap[]; };
layout(scalar, binding = 10) buffer Candidates { uint candidates[]; };  // by quarter pixel: a cell of the index map, or one of these
layout(scalar, binding = 11) buffer Groups { uint new_by_group[]; };
layout(scalar, binding = 12) buffer State { MapState state; };
layout(scalar, push_constant) uniform Push { FuseParams p; };

const uint kInvalid = 0xffffffffu;  // nothing to fuse here
const uint kNew = 0xfffffffeu;      // a surface the map does not have yet

struct Measurement {
  vec3 position;  // camera frame
  vec3 normal;
  float radius_m;
  vec2 curvatures;
  vec3 color;
  float confidence;
};

uvec2 quarter_size() { return uvec2((p.camera.width + 1u) / 2u, (p.camera.height + 1u) / 2u); }

// The pixel of a quarter-grid invocation; false outside the image.
bool quarter_pixel(uint quarter, out ivec2 pixel, out uint index) {
  uvec2 size = quarter_size();
  pixel = ivec2(2u * (quarter % size.x) + p.parity_x, 2u * (quarter / size.x) + p.parity_y);
  index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  return quarter < size.x * size.y && inside(p.camera, pixel);
}

float fused_depth_m(uint index) { return p.fuse_surface != 0u ? surface_depth_m[index] : raw_depth_m[index]; }

bool can_be_fused(uint index) { return surface_depth_m[index] > 0.0 && raw_depth_m[index] > 0.0; }

Measurement measure(ivec2 pixel, uint index) {
  vec3 normal = unpack_normal(frame_normals[index]);
  uint c = frame_color[index];
  return Measurement(pixel_ray(p.camera, vec2(pixel)) * fused_depth_m(index), normal,
                     support_radius(p.camera, p.radius_scale, surface_depth_m[index], normal.z), unpackHalf2x16(frame_curvatures[index]),
                     vec3(c & 255u, (c >> 8) & 255u, (c >> 16) & 255u), frame_confidence[index]);
}
