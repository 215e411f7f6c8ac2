// A frame at its coarsest resolution on the host, for comparisons over several frames that need no
// detail.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/surface_pyramid.h"

namespace hermite::frame {

// Row major, camera.width * camera.height entries each; camera frame, metres.
struct CoarseView {
  shared::Intrinsics camera{};
  std::vector<float> depth_m;  // 0: no surface
  // Unit length, away from the camera; zero without a surface.
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> grey;  // 0 to 255

  bool empty() const { return depth_m.empty(); }
  std::size_t size() const { return depth_m.size(); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * camera.width + static_cast<std::size_t>(x);
  }
  bool contains(int x, int y) const {
    return x >= 0 && y >= 0 && x < static_cast<int>(camera.width) &&
           y < static_cast<int>(camera.height);
  }
  // Returns the point at the pixel's centre, which must have a surface.
  Eigen::Vector3d point(int x, int y) const;
  Eigen::Vector2d project(const Eigen::Vector3d& point) const;
};

// Returns the points at the centres of all pixels, row major; zero where there is no surface.
std::vector<Eigen::Vector3d> points_of(const CoarseView& view);

// Copies the coarsest level. Blocks until it is copied; the passes that fill it must have run.
CoarseView coarse_view(const SurfacePyramid& surface);

// Pixels of a coarse view; 1: belongs to the region.
using CoarseMask = std::vector<shared::uint>;

void save(ByteWriter& bytes, const CoarseView& view);
// The reader fails when the numbers of pixels are inconsistent.
void restore(ByteReader& bytes, CoarseView& view);

}  // namespace hermite::frame
