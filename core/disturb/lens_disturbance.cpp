#include "core/disturb/lens_disturbance.h"

#include <vector>

#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/disturb/moved_view.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/math/depth_between.h"

namespace hermite::disturb {
namespace {

class Distorted : public RedrawnSequence {
 public:
  Distorted(std::unique_ptr<dataset::Sequence> original, const Distortion& distortion)
      : RedrawnSequence(std::move(original)) {
    Camera lens = original_->camera();
    lens.distortion = distortion;
    for (int y = 0; y < lens.height; ++y)
      for (int x = 0; x < lens.width; ++x) sources_px_.push_back(lens.undistort(x, y));
  }

 private:
  // Beyond the border of the original image there is no depth, and the border's colour.
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t) const override {
    const DepthImage straight_depth = depth;
    const ColorImage straight_color = color;
    for (std::size_t i = 0; i < sources_px_.size(); ++i) {
      const Eigen::Vector2d& at_px = sources_px_[i];
      depth.pixels[i] = depth_between(straight_depth, at_px.x(), at_px.y());
      color.pixels[i] = rounded(color_at(
          straight_color,
          at_px.cwiseMax(0.0).cwiseMin(Eigen::Vector2d(depth.width - 1, depth.height - 1))));
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
