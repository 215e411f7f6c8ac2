// What the frames of a sequence have seen of its scene, as coloured triangles in the world, and their picture from anywhere.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/dataset/sequence.h"

namespace hermite {

struct ColoredPoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3f color = Eigen::Vector3f::Zero();  // 0 to 255, sRGB
};

struct SeenSurface {
  std::vector<ColoredPoint> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of points
};

// From up to 24 frames spread over the sequence, at their true poses, every so-many-th pixel such that 160 of them are across; no triangle
// spans more than 5 % of the depth. Frames that have no pose or cannot be read are left out.
SeenSurface seen_surface(const Sequence& sequence);

// The nearest of the triangles in every pixel for which it is asked. Their points are in the frame of the camera here.
struct DrawnPixel {
  double depth_m = 0;  // 0: no triangle
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
};
Image<DrawnPixel> draw(const SeenSurface& surface_in_camera, const Camera& camera, const Image<std::uint8_t>& is_asked);

}  // namespace hermite
