// Points and planes of the true surface, and where a reconstruction has the points: to judge what is measured in a scan.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/sequence.h"

namespace hermite {

// A pixel of one of the frames that are looked at.
struct TruePixel {
  std::size_t view = 0;
  int x = 0, y = 0;
};

struct TruePoint {
  TruePixel pixel;                                        // that shows it
  Eigen::Vector3d true_m = Eigen::Vector3d::Zero();       // in the true world
  Eigen::Vector3d estimated_m = Eigen::Vector3d::Zero();  // in the estimate's: the mean over frames that see it, each by its own two poses
};

// As far as one frame shows it, in the true world.
struct TruePlane {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();  // unit, towards the camera
  std::vector<TruePixel> pixels;
};

// Const and thread-safe once it is made.
class TruePlaces {
 public:
  // Of up to 120 frames of `sequence`, spread evenly, whose depth is without noise. kNotFound: no true poses, no pose of the estimate at
  // the time of a frame.
  static Result<TruePlaces> of(const Sequence& sequence, const Trajectory& estimate);

  // The first `count` random pixels of random frames, the same for the same seed. Those that show nothing 0.4 to 4.5 m deep, or what no
  // frame that has an estimate sees, are left out. A frame sees a point where its depth is the point's, within 1 cm and 1 %. No alignment
  // of the two worlds is needed, and none is made.
  std::vector<TruePoint> points(std::size_t count, std::uint64_t seed) const;
  std::optional<TruePoint> point_at(const TruePixel& pixel) const;  // none: left out for such a reason

  // Around a pixel, as far as neighbours of neighbours lie within 1.5 mm of one plane. None: less than some 14 cm broad (standard deviation
  // 4 cm), fewer than 400 pixels, or bent: within 4.5 mm of it there are more than a fifth more.
  std::optional<TruePlane> plane_at(const TruePixel& pixel) const;

  // What is up in the true world: that of its axes which the first camera's up is nearest to. True worlds stand upright.
  Eigen::Vector3d true_up() const;
  Eigen::Quaterniond estimate_from_true() const;  // how the estimate's world is turned: the mean over the frames

 private:
  struct View {
    DepthImage depth;
    Rigid3 true_from_camera, estimate_from_camera;
  };

  explicit TruePlaces(const Camera& camera) : camera_(camera) {}
  double depth_m(const TruePixel& pixel) const;
  Eigen::Vector3d true_m(const TruePixel& pixel) const;
  bool sees(const View& view, const Eigen::Vector3d& in_camera) const;
  std::vector<TruePixel> connected(const TruePixel& from, const TruePlane& plane, double within_m) const;

  Camera camera_;
  std::vector<View> views_;
};

}  // namespace hermite
