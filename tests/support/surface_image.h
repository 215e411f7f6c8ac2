// Surface maps on the host, unpacked: what tests compare, and what they feed to passes. The only
// place of the tests, beside packing.h, that knows how these maps are stored.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/frame/preprocess.h"
#include "core/map/surfel_store.h"

namespace hermite::test {

struct SurfaceImage {
  explicit SurfaceImage(const shared::Intrinsics& intrinsics);  // empty everywhere

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * camera.width + static_cast<std::size_t>(x);
  }
  std::size_t size() const { return depth_m.size(); }
  // The point of pixel (x, y) with z = 1.
  Eigen::Vector3d ray(int x, int y) const;
  Eigen::Vector3d vertex(int x, int y) const {
    return static_cast<double>(depth_m[index(x, y)]) * ray(x, y);
  }

  shared::Intrinsics camera;
  std::vector<float> depth_m;               // 0: empty
  std::vector<Eigen::Vector3d> normals;     // unit, away from the camera; zero where empty
  std::vector<Eigen::Vector2d> curvatures;  // max, min [1/m]
  std::vector<float> weight;
  std::vector<float> intensity;  // -1: none
};

SurfaceImage download(const frame::SurfaceLevel& level);
void upload(const SurfaceImage& image, frame::SurfaceLevel& level);

std::vector<Eigen::Vector3d> unpack_normals(const std::vector<shared::uint>& packed);

// Camera of a pyramid level when every pixel is sampled.
shared::Intrinsics intrinsics_of_level(const Camera& camera, int level);

// Empty maps of a frame of every pixel, to be filled by the test instead of a Preprocessor.
frame::FrameMaps make_frame_maps(gpu::Device& device, const Camera& camera);

// Replaces the content of the store: surfel i in slot i. Those without confidence become free
// slots, listed in the first zone until a cleaning lists them where they belong.
void upload(const std::vector<map::Surfel>& surfels, map::SurfelStore& store);

// The list of free slots: all of it, and the part of each zone.
std::vector<std::uint32_t> free_slots(const map::SurfelStore& store);
std::vector<std::vector<std::uint32_t>> free_slots_by_zone(const map::SurfelStore& store);

}  // namespace hermite::test
