#include "server/capture/frame_pairing.h"

#include <cmath>
#include <utility>

namespace hermite::client {

void FramePairing::add_depth(double time_s, DepthImage depth) {
  if (last_depth_s_ && time_s <= *last_depth_s_) return;
  last_depth_s_ = time_s;
  depths_.push_back({time_s, std::move(depth)});
  if (depths_.size() <= kMaxWaiting) return;
  depths_.pop_front();
  ++unpaired_depth_count_;
}

void FramePairing::add_color(double time_s, ColorImage color) {
  if (last_color_s_ && time_s <= *last_color_s_) return;
  last_color_s_ = time_s;
  colors_.push_back({time_s, std::move(color)});
  if (colors_.size() > kMaxWaiting) colors_.pop_front();
}

std::optional<frame::RgbdFrame> FramePairing::take() {
  while (!depths_.empty()) {
    const double at_s = depths_.front().time_s;
    const bool no_better_comes =
        (last_color_s_ && *last_color_s_ >= at_s) || *last_depth_s_ > at_s + max_gap_s_;
    if (!no_better_comes) return std::nullopt;
    const auto gap_s = [&](const Timed<ColorImage>& color) {
      return std::abs(color.time_s - at_s);
    };
    while (colors_.size() > 1 && gap_s(colors_[1]) <= gap_s(colors_[0])) colors_.pop_front();
    Timed<DepthImage> depth = std::move(depths_.front());
    depths_.pop_front();
    if (colors_.empty() || gap_s(colors_.front()) > max_gap_s_) {
      ++unpaired_depth_count_;
      continue;
    }
    frame::RgbdFrame frame{at_s, std::move(depth.image), std::move(colors_.front().image)};
    colors_.pop_front();
    return frame;
  }
  return std::nullopt;
}

}  // namespace hermite::client
