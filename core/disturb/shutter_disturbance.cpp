#include "core/disturb/shutter_disturbance.h"

#include <cmath>

#include "core/disturb/depth_units.h"
#include "core/disturb/key_values.h"
#include "core/disturb/moved_view.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/disturb/true_view.h"

namespace hermite::disturb {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMax_ms = 100;
// Number of views per exposure; at 100 ms and the speed of a hand they are 4 pixels of 640 apart.
constexpr int kBlurViews = 9;

// A sequence whose frames are seen from the camera's poses at other times.
class Shuttered : public RedrawnSequence {
 public:
  Shuttered(std::unique_ptr<dataset::Sequence> original, const char* name, double duration_ms)
      : RedrawnSequence(std::move(original)),
        name_(name),
        duration_s_(duration_ms / 1000),
        rays_(rays_of(camera())) {}

 protected:
  // Returns the transform to the camera at one time from the camera at another.
  Result<Rigid3> motion(double to_s, double from_s) const {
    const Result<Rigid3> to = true_pose(*original_, to_s, name_),
                         from = true_pose(*original_, from_s, name_);
    if (!to.ok()) return to.error();
    if (!from.ok()) return from.error();
    return inverse(*to) * *from;
  }
  MovedView view_of(const DepthImage& depth) const { return {camera(), rays_, depth}; }

  const std::string name_;
  const double duration_s_;

 private:
  const Image<Vector3d> rays_;
};

class Rolling : public Shuttered {
 public:
  using Shuttered::Shuttered;

 private:
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const override {
    const DepthImage whole_depth = depth;
    const ColorImage whole_color = color;
    const MovedView view = view_of(whole_depth);
    for (int y = 0; y < depth.height; ++y) {
      const double later_s = duration_s_ * (static_cast<double>(y) / (depth.height - 1) - 0.5);
      const Result<Rigid3> frame_from_row =
          motion(timestamp_s(index), timestamp_s(index) + later_s);
      if (!frame_from_row.ok()) return frame_from_row.error();
      for (int x = 0; x < depth.width; ++x) {
        const SeenPlace seen = view.find(x, y, *frame_from_row);
        depth.at(x, y) = to_depth_units(seen.depth_m, camera().depth_units_per_metre);
        color.at(x, y) = rounded(color_at(whole_color, seen.at_px));
      }
    }
    return Done{};
  }
};

class Late : public Shuttered {
 public:
  using Shuttered::Shuttered;

 private:
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const override {
    const double color_s = timestamp_s(index) + duration_s_;
    const std::int64_t nearest = nearest_frame(index, color_s);
    const Result<Rigid3> frame_from_color = motion(timestamp_s(nearest), color_s);
    if (!frame_from_color.ok()) return frame_from_color.error();
    if (nearest == index) {
      color = seen_from(*frame_from_color, depth, color);
      return Done{};
    }
    Result<dataset::RecordedFrame> other = original_->read(nearest);
    if (!other.ok()) return other.error();
    const Result<frame::RgbdFrame> decoded = dataset::decode_frame(std::move(*other));
    if (!decoded.ok()) return decoded.error();
    color = seen_from(*frame_from_color, decoded->depth, decoded->color);
    return Done{};
  }

  std::int64_t nearest_frame(std::int64_t index, double time_s) const {
    const auto away_s = [&](std::int64_t i) { return std::abs(timestamp_s(i) - time_s); };
    while (index + 1 < frame_count() && away_s(index + 1) < away_s(index)) ++index;
    while (index > 0 && away_s(index - 1) < away_s(index)) --index;
    return index;
  }

  ColorImage seen_from(const Rigid3& frame_from_moved, const DepthImage& depth,
                       const ColorImage& color) const {
    const MovedView view = view_of(depth);
    ColorImage moved(color.width, color.height);
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x)
        moved.at(x, y) = rounded(color_at(color, view.find(x, y, frame_from_moved).at_px));
    return moved;
  }
};

class Blurred : public Shuttered {
 public:
  using Shuttered::Shuttered;

 private:
  // The content of a pixel is taken to move linearly from the start of the exposure to its middle,
  // and on to its end.
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const override {
    const double middle_s = timestamp_s(index);
    const Result<Rigid3> frame_from_first = motion(middle_s, middle_s - duration_s_ / 2),
                         frame_from_last = motion(middle_s, middle_s + duration_s_ / 2);
    if (!frame_from_first.ok()) return frame_from_first.error();
    if (!frame_from_last.ok()) return frame_from_last.error();
    const ColorImage sharp = color;
    const MovedView view = view_of(depth);
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x) {
        const Vector2d middle_px(x, y);
        const Vector2d to_first_px = view.find(x, y, *frame_from_first).at_px - middle_px,
                       to_last_px = view.find(x, y, *frame_from_last).at_px - middle_px;
        Vector3d sum = Vector3d::Zero();
        for (int i = 0; i < kBlurViews; ++i) {
          const double later = 2.0 * i / (kBlurViews - 1) - 1;
          sum +=
              color_at(sharp, middle_px + std::abs(later) * (later < 0 ? to_first_px : to_last_px));
        }
        color.at(x, y) = rounded(sum / kBlurViews);
      }
    return Done{};
  }
};

template <class Disturbed>
Result<std::unique_ptr<dataset::Sequence>> shuttered(std::unique_ptr<dataset::Sequence> sequence,
                                                     const char* name, const std::string& options,
                                                     double least_ms, double duration_ms) {
  const Status status =
      apply_key_values(options, {number_rule("ms", least_ms, kMax_ms, duration_ms)});
  if (!status.ok()) return in_context(name, status.error());
  if (const Status registered = check_registered(*sequence, name); !registered.ok())
    return registered.error();
  if (const Result<Stage> stage = stage_of(*sequence, name); !stage.ok()) return stage.error();
  return std::unique_ptr<dataset::Sequence>(
      std::make_unique<Disturbed>(std::move(sequence), name, duration_ms));
}

}  // namespace

Result<std::unique_ptr<dataset::Sequence>> with_rolling(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options) {
  return shuttered<Rolling>(std::move(sequence), "rolling", options, 0, 30);
}

Result<std::unique_ptr<dataset::Sequence>> with_clock(std::unique_ptr<dataset::Sequence> sequence,
                                                      const std::string& options) {
  return shuttered<Late>(std::move(sequence), "clock", options, -kMax_ms, 16);
}

Result<std::unique_ptr<dataset::Sequence>> with_blur(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options) {
  return shuttered<Blurred>(std::move(sequence), "blur", options, 0, 15);
}

}  // namespace hermite::disturb
