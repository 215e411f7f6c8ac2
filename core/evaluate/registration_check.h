// Checks whether depth is registered to colour. Depth edges lie on image edges; if they fit better
// when magnified or shifted, the images are from two cameras. Deterministic; one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite::evaluate {

// The transform of depth that fits colour best: u' = scale (u - cx) + cx + dx, with cx in the
// middle of the image.
struct RegistrationFit {
  double scale = 1;
  int dx_px = 0, dy_px = 0;
  // Mean image gradient under the transformed depth edges, relative to that without the transform.
  double gain = 1;
  double worst_px = 0;  // the largest resulting displacement at the border of the image
  // Returns whether gain and displacement are large enough to tell the user.
  bool is_doubtful() const;
};

class RegistrationCheck {
 public:
  // The frame has the camera's size.
  void add(const frame::RgbdFrame& frame, double depth_units_per_metre);

  // Returns std::nullopt if there were too few depth edges.
  std::optional<RegistrationFit> fit() const;

 private:
  static constexpr int kScales = 13, kShiftsX = 25, kShiftsY = 13;
  struct Sum {
    double gradient = 0;
    std::int64_t count = 0;
  };
  std::vector<Sum> sums_ =
      std::vector<Sum>(static_cast<std::size_t>(kScales * kShiftsX * kShiftsY));
  int width_ = 0, height_ = 0;
  std::int64_t edge_count_ = 0;
};

}  // namespace hermite::evaluate
