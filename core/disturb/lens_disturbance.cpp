#include "core/disturb/lens_disturbance.h"

#include <cmath>
#include <vector>

#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/disturb/moved_view.h"
#include "core/disturb/redrawn_sequence.h"

namespace hermite::disturb {
namespace {

// The inverse of Distortion::apply by fixed-point iteration, as in OpenCV: each step reduces the
// error by the distortion itself, at most a third in the corners.
Eigen::Vector2d undistorted(const Distortion& distortion, const Eigen::Vector2d& at) {
  constexpr int kSteps = 30;
  Eigen::Vector2d straight = at;
  for (int i = 0; i < kSteps; ++i) straight += at - distortion.apply(straight.x(), straight.y());
  return straight;
}

class Distorted : public RedrawnSequence {
 public:
  Distorted(std::unique_ptr<dataset::Sequence> original, const Distortion& distortion)
      : RedrawnSequence(std::move(original)) {
    const Camera& camera = original_->camera();
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector2d at =
            undistorted(distortion, {(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy});
        sources_px_.emplace_back(at.x() * camera.fx + camera.cx, at.y() * camera.fy + camera.cy);
      }
  }

 private:
  // Beyond the border of the original image nothing is known: black and without depth.
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t) const override {
    const DepthImage straight_depth = depth;
    const ColorImage straight_color = color;
    for (std::size_t i = 0; i < sources_px_.size(); ++i) {
      const Eigen::Vector2d& at_px = sources_px_[i];
      const bool is_inside = at_px.x() >= 0 && at_px.y() >= 0 && at_px.x() <= depth.width - 1 &&
                             at_px.y() <= depth.height - 1;
      depth.pixels[i] = is_inside ? straight_depth.at(static_cast<int>(std::lround(at_px.x())),
                                                      static_cast<int>(std::lround(at_px.y())))
                                  : std::uint16_t{0};
      color.pixels[i] = is_inside ? rounded(color_at(straight_color, at_px)) : Rgb8{};
    }
    return Done{};
  }

  std::vector<Eigen::Vector2d> sources_px_;  // by pixel
};

}  // namespace

Result<std::unique_ptr<dataset::Sequence>> with_lens(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options) {
  Distortion distortion;
  distortion.k1 = -0.05;
  const Status status = apply_key_values(options, {number_rule("k1", -0.4, 0.4, distortion.k1),
                                                   number_rule("k2", -0.4, 0.4, distortion.k2)});
  return when_ok<Distorted>(status, "lens", std::move(sequence), distortion);
}

}  // namespace hermite::disturb
