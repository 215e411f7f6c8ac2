// What the frames of a sequence have seen of its scene, as coloured triangles in the world, and its
// rendering from any viewpoint.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/dataset/sequence.h"

namespace hermite::disturb {

struct ColoredPoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3f color = Eigen::Vector3f::Zero();  // 0 to 255, sRGB
};

struct SeenSurface {
  std::vector<ColoredPoint> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of points
};

// Returns the surface from up to 24 frames spread over the sequence, at their true poses, with
// about 160 samples per image row; no triangle spans more than 5 % of the depth. Frames that have
// no pose or cannot be read are skipped.
SeenSurface seen_surface(const dataset::Sequence& sequence);

// Renders the nearest triangle in every requested pixel. The surface is in the coordinate frame of
// the camera.
struct DrawnPixel {
  double depth_m = 0;  // 0: no triangle
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
};
Image<DrawnPixel> draw(const SeenSurface& surface_in_camera, const Camera& camera,
                       const Image<std::uint8_t>& is_asked);

}  // namespace hermite::disturb
