// The passes of shaders/map once more, on the CPU in double precision and one surfel or pixel after
// the other (paper section 3.1 and 5). Inputs are downloaded surfels, so packing has already
// happened to both sides. Pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/map/map_options.h"
#include "core/map/surfel_store.h"
#include "core/math/hrbf.h"
#include "tests/support/surface_image.h"

namespace hermite::test {

// Where a map is seen from.
struct MapView {
  shared::Intrinsics camera;
  std::vector<Rigid3> camera_from_submap{Rigid3{}};

  Eigen::Vector3d position_m(const map::Surfel& surfel) const {
    return camera_from_submap[surfel.submap] * surfel.position_in_submap_m.cast<double>();
  }
  Eigen::Vector3d normal(const map::Surfel& surfel) const {
    return camera_from_submap[surfel.submap].rotation * surfel.normal_in_submap.cast<double>();
  }
};

// Returns by pixel the slot of the nearest surfel of at least that confidence, kNoSurfel where
// there is none; of several at one depth the lowest.
std::vector<std::uint32_t> index_map_twin(const std::vector<map::Surfel>& surfels,
                                          const MapView& view, double min_confidence);

// The surfels that pixel (x, y) may use as kernels: in its window of the index map, alive, facing
// away. `slots` names them.
std::vector<HrbfKernel> prediction_window(const std::vector<map::Surfel>& surfels,
                                          const MapView& view,
                                          const std::vector<std::uint32_t>& ids, int x, int y,
                                          int window, std::vector<std::uint32_t>& slots);

// The predicted surface, by HRBF or by splats as the options say; without fill-in. -1 is the
// intensity of empty pixels.
SurfaceImage predict_twin(const std::vector<map::Surfel>& surfels, const MapView& view,
                          const std::vector<std::uint32_t>& ids, const map::MapOptions& options);

// (confidence scale * c + exp(-lambda^2 / (2 kappa^2))) / z^2.
double tracking_weight_twin(const Eigen::Vector2d& curvatures, double confidence, double depth_m,
                            const map::MapOptions& options);

// What the Fuser sees of a frame.
struct FuseInput {
  SurfaceImage surface;
  std::vector<float> raw_depth_m;
  std::vector<Rgb8> color;
};

struct FuseSettings {
  map::MapOptions map;
  double curvature_limit_per_m = 300,
         support_radius_scale = frame::FrameOptions{}.support_radius_scale;
  std::uint32_t frame_number = 0;
};

struct FuseOutcome {
  std::vector<map::Surfel> surfels;  // all slots afterwards
  int merged_count = 0, beaten_count = 0, new_count = 0;
  // How close the closest decision was, in its own unit of about one: below 1e-4 another rounding
  // might have decided otherwise.
  double closest_decision = 1e9;
};

// Where in the view new surfels and free slots find each other: 4 x 4 zones of tiles of 16 x 16
// pixels.
std::size_t zone_of_tile_at(const shared::Intrinsics& camera, int x, int y);

// All pixels fused. Zone by zone and tile by tile new surfels use the free slots of their zone
// first, in order.
FuseOutcome fuse_twin(const std::vector<map::Surfel>& surfels,
                      const std::vector<std::vector<std::uint32_t>>& free_slots,
                      const MapView& view, const std::vector<std::uint32_t>& ids,
                      const FuseInput& frame, const FuseSettings& settings);

}  // namespace hermite::test
