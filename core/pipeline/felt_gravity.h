// Which way is up, from what the camera's accelerometer felt while its poses were known.
//
// At rest an accelerometer feels what holds it against gravity: a vector of 9.8 m/s^2 that points
// up. In a hand it also feels the motion, but the mean of that over a scan is the change of
// velocity by its duration. So up u (world) and the sensor's bias b (camera) are those that
// minimise
//   sum |R_i^T u + b - a_i|^2 / sigma^2 + |b|^2 / sigma_b^2
// over all frames, with R_i = world_from_camera and a_i as felt. The bias is seen as soon as the
// camera turns. sigma is the residuals' own.
//
// Sums are kept for each submap, so that up follows corrections of the map. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/adjust/mapping.h"
#include "core/base/byte_stream.h"
#include "core/math/up_direction.h"
#include "core/pipeline/frame_result.h"

namespace hermite::pipeline {

struct FeltUp {
  std::optional<UpDirection> up;  // in the world of the part of the map with most frames
  std::string problem;  // why there is none, for people; empty when no accelerometer spoke
};

class FeltGravity {
 public:
  // Adds what was felt before the frame with this pose, the newest one. Lost frames are ignored,
  // and what is not finite or more than an accelerometer measures.
  void add(const std::optional<Eigen::Vector3d>& acceleration_m_s2, const AnchoredPose& pose);

  FeltUp in_world(const adjust::MapLayout& layout) const;

  // The state in a checkpoint, both ways.
  template <class Bytes, class Saved>
  static void fields(Bytes& bytes, Saved& saved);
  bool is_valid(std::size_t submap_count) const { return sums_.size() <= submap_count; }

 private:
  // Of the frames of one submap.
  struct Sums {
    std::int64_t frames = 0;
    std::int64_t motions = 0;  // independent movements of a hand in this time
    Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero();  // submap_from_camera
    Eigen::Vector3d felt_in_submap = Eigen::Vector3d::Zero();
    Eigen::Vector3d felt_in_camera = Eigen::Vector3d::Zero();
    double squares = 0;
    void add(const Sums& other, const Eigen::Matrix3d& from_other);
  };
  struct Solution {
    Eigen::Vector3d up = Eigen::Vector3d::Zero();  // m/s^2
    double residual_m_s2 = 0;                      // standard deviation of one component
    double sigma_rad = 0;
  };
  static Solution solve(const Sums& sums);

  std::vector<Sums> sums_;  // by submap
  std::int64_t unusable_ = 0;
  double motion_began_s_ = 0;
};

template <class Bytes, class Saved>
void FeltGravity::fields(Bytes& bytes, Saved& saved) {
  bytes.list(saved.sums_, [](auto& to, auto& sums) {
    to.number(sums.frames);
    to.number(sums.motions);
    to.numbers(sums.rotations.data(), 9);
    to.numbers(sums.felt_in_submap.data(), 3);
    to.numbers(sums.felt_in_camera.data(), 3);
    to.number(sums.squares);
  });
  bytes.number(saved.unusable_);
  bytes.number(saved.motion_began_s_);
}

}  // namespace hermite::pipeline
