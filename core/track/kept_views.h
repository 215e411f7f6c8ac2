// Views kept along the camera's path, and what the surface that a frame shares with them says about
// its pose. Used by core/track/map_certainty.h, which explains the model.
//
// Pure functions on the host. Any thread.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "core/track/shared_ground.h"

namespace hermite::track {

// The present layout of the map.
struct MapGround {
  const std::vector<Rigid3>& world_from_submap;
  const std::vector<bool>& is_active;  // by submap: whether it is tracked against
  std::uint32_t current = 0;           // submap of new surfels
  std::uint64_t closure_count = 0;     // loops closed so far
};

struct KeptView {
  frame::CoarseView seen;  // thinned, without moving pixels
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;

  bool is_tracked_against(const MapGround& ground) const {
    return submap < ground.is_active.size() && ground.is_active[submap];
  }
  Rigid3 world_from_camera(const MapGround& ground) const {
    return ground.world_from_submap[submap] * submap_from_camera;
  }
};

// The surface that constrains a frame. Information is that about a twist about the world's origin.
struct KnownSurface {
  // By view, from the surface first seen in it; each pixel counts for the oldest view that shows
  // it.
  std::vector<Matrix6d> information;
  Matrix6d whole = Matrix6d::Zero();
  // Weighted displacement of the points by the camera's errors.
  Eigen::Matrix<double, 6, kCameraDoubtCount> camera =
      Eigen::Matrix<double, 6, kCameraDoubtCount>::Zero();
  std::size_t surface_count = 0;  // pixels with a surface
  double known_share = 0;         // share of these on known surface
  // In the world, of the points on surface of the first views.
  Eigen::AlignedBox3d of_first_views;
};

// A frame, reduced as kept views are.
struct ThinnedFrame {
  const frame::CoarseView& seen;
  const Rigid3& world_from_camera;
};

// Returns the surface of the frame that the views have seen. The first `first_view_count` of them
// are those for KnownSurface::of_first_views.
KnownSurface known_surface(const ThinnedFrame& thinned_frame, std::span<const KeptView> views,
                           std::size_t first_view_count, const MapGround& ground);

// Returns the covariance of the errors of a new view's surface in addition to the noise of its
// step, as a twist about the world's origin. `surface_share`: of the view's pixels, those that have
// a surface.
Matrix6d surface_bias(double surface_share, const Rigid3& last_from_camera,
                      const Eigen::Vector3d& position_world);

// Returns the longest side [m], along the world's axes, of what the views have seen.
double extent_m(std::span<const KeptView> views, const MapGround& ground);

// Returns the positions of the views in the world; zero of a view whose submap is missing, as in a
// damaged checkpoint.
std::vector<Eigen::Vector3d> positions_of(std::span<const KeptView> views, const MapGround& ground);

}  // namespace hermite::track
