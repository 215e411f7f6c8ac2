// Is depth registered to colour? Edges of depth lie on edges of the picture: where they would lie better on it magnified or shifted, the
// images come from two cameras. Deterministic; one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"

namespace hermite {

// How depth would have to be moved to lie on colour: u' = scale (u - cx) + cx + dx, from the middle of the image.
struct RegistrationFit {
  double scale = 1;
  int dx_px = 0, dy_px = 0;
  double gain = 1;      // mean picture gradient under the depth edges, as a multiple of that where they are
  double worst_px = 0;  // the largest displacement that this means at the border of the image
  // Enough of both to be worth a word to the user.
  bool is_doubtful() const;
};

class RegistrationCheck {
 public:
  // Frames of the camera's size.
  void add(const RgbdFrame& frame, double depth_units_per_metre);

  // Nothing when there were too few depth edges to tell.
  std::optional<RegistrationFit> fit() const;

 private:
  static constexpr int kScales = 13, kShiftsX = 25, kShiftsY = 13;
  struct Sum {
    double gradient = 0;
    std::int64_t count = 0;
  };
  std::vector<Sum> sums_ = std::vector<Sum>(static_cast<std::size_t>(kScales * kShiftsX * kShiftsY));
  int width_ = 0, height_ = 0;
  std::int64_t edge_count_ = 0;
};

}  // namespace hermite
