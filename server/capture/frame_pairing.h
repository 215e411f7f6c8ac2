// Pairs colour with depth images by timestamp as they arrive. A single-threaded value.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "core/base/image.h"
#include "core/frame/rgbd_frame.h"

namespace hermite::client {

// Pairs each depth image with the colour image nearest in time, at most `max_gap_s` away; each
// image is used once. A pair is available as soon as no better one can arrive: with the first
// colour image that is not before the depth image, or when another depth image is already that much
// later. The images of each kind must arrive in order of time; others are dropped.
class FramePairing {
 public:
  explicit FramePairing(double max_gap_s) : max_gap_s_(max_gap_s) {}

  void add_depth(double time_s, DepthImage depth);
  void add_color(double time_s, ColorImage color);

  // Returns pairs in order of time, with the timestamp of the depth image.
  std::optional<frame::RgbdFrame> take();

  std::uint64_t unpaired_depth_count() const { return unpaired_depth_count_; }

  static constexpr std::size_t kMaxWaiting = 4;  // of each kind; beyond that the oldest is dropped

 private:
  template <class Image>
  struct Timed {
    double time_s;
    Image image;
  };

  const double max_gap_s_;
  std::deque<Timed<DepthImage>> depths_;
  std::deque<Timed<ColorImage>> colors_;
  std::optional<double> last_depth_s_, last_color_s_;
  std::uint64_t unpaired_depth_count_ = 0;
};

}  // namespace hermite::client
