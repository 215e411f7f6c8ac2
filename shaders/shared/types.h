// Plain data shared by C++ and GLSL. Scalar layout: the shader reads the layout of C++.
#ifndef HERMITE_SHARED_TYPES_H
#define HERMITE_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>
namespace hermite::shared {
using uint = std::uint32_t;
struct vec2 {
  float x, y;
};
struct vec4 {
  float x, y, z, w;
};
struct uvec2 {
  uint x, y;
};
struct uvec4 {
  uint x, y, z, w;
};
#endif

#define HERMITE_NONE 0xffffffffu  // in place of an index: there is no surfel, pixel, cell or submap

// Pinhole camera of one pyramid level. Pixel centres are integers.
struct Intrinsics {
  float fx, fy, cx, cy;  // pixels
  uint width, height;    // pixels
};

// Sample (x, y) is pixel step * (x, y) + offset (x, y) of the image.
struct Sampling {
  uint step;
  uint x, y;  // offset, below step
};

// Images of kernels (shaders/lib/kernels.glsl): the width of the margin around them, half the
// largest window, and the distance from row to row. Invocations of four pixels reach three pixels
// farther to the right.
#define HERMITE_KERNEL_MARGIN 4
#define HERMITE_KERNEL_STRIDE(width) ((width) + 2 * HERMITE_KERNEL_MARGIN + 3)

// A surface as seen from one pose, by pixel (shaders/lib/surface_point.glsl).
struct SurfacePoint {
  float depth_m;    // along the pixel's ray; 0: there is none
  uint normal;      // unit, camera frame, away from the camera: x and y as 2 x snorm16
  uint curvatures;  // max, min [1/m] as 2 x half float
  float weight;     // of a frame: confidence, 0 to 1; of a prediction: tracking weight
};

// Grey value and gradient of an image pixel.
struct GreyAndGradient {
  float grey;     // 0 to 255
  uint gradient;  // grey values per pixel, 2 x half float
};

// target_from_source: p_target = (dot(row0.xyz, p) + row0.w, ...). Metres.
struct Transform {
  vec4 row0, row1, row2;
};

#ifdef __cplusplus
}  // namespace hermite::shared
#endif
#endif
