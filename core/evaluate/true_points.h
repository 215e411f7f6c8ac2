// Points and planes of the true surface, and the positions of the points in a reconstruction, to
// judge measurements in a scan.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/sequence.h"

namespace hermite::evaluate {

// A pixel of one of the examined frames.
struct TruePixel {
  std::size_t view = 0;
  int x = 0, y = 0;
};

struct TruePoint {
  TruePixel pixel;                                   // the pixel that shows it
  Eigen::Vector3d true_m = Eigen::Vector3d::Zero();  // in the true world
  // In the world of the estimate: the mean over frames that see it, each transformed by its true
  // and its estimated pose.
  Eigen::Vector3d estimated_m = Eigen::Vector3d::Zero();
};

// A plane as far as one frame shows it, in the true world.
struct TruePlane {
  // Unit, towards the camera.
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  std::vector<TruePixel> pixels;
};

// Const and thread-safe after construction.
class TruePlaces {
 public:
  // Uses up to 120 frames of `sequence`, spread evenly, whose depth is without noise. kNotFound
  // when there are no true poses, or no pose of the estimate at the time of a frame.
  static Result<TruePlaces> of(const dataset::Sequence& sequence,
                               const dataset::Trajectory& estimate);

  // Returns the points at the first `count` random pixels of random frames, the same for the same
  // seed. Pixels are skipped if they show nothing at 0.4 to 4.5 m, or a point that no frame with an
  // estimate sees. A frame sees a point if its depth is that of the point within 1 cm and 1 %. The
  // two worlds need not be aligned.
  std::vector<TruePoint> points(std::size_t count, std::uint64_t seed) const;
  // Nullopt: skipped for one of these reasons.
  std::optional<TruePoint> point_at(const TruePixel& pixel) const;

  // Returns the plane around a pixel, grown over neighbours within 1.5 mm of it; std::nullopt if it
  // is less than about 14 cm wide (standard deviation 4 cm), has fewer than 400 pixels, or is bent:
  // more than a fifth more pixels within 4.5 mm.
  std::optional<TruePlane> plane_at(const TruePixel& pixel) const;

  // Returns the axis of the true world that is nearest to the first camera's up direction. True
  // worlds are upright.
  Eigen::Vector3d true_up() const;
  // Rotation of the estimate's world: the mean over the frames.
  Eigen::Quaterniond estimate_from_true() const;

 private:
  struct View {
    DepthImage depth;
    Rigid3 true_from_camera, estimate_from_camera;
  };

  explicit TruePlaces(const Camera& camera) : camera_(camera) {}
  double depth_m(const TruePixel& pixel) const;
  Eigen::Vector3d true_m(const TruePixel& pixel) const;
  bool sees(const View& view, const Eigen::Vector3d& in_camera) const;
  std::vector<TruePixel> connected(const TruePixel& from, const TruePlane& plane,
                                   double within_m) const;

  Camera camera_;
  std::vector<View> views_;
};

}  // namespace hermite::evaluate
