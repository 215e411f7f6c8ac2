// Means over the frames of a scan: of the first hundred all count alike, then later frames replace
// earlier ones. One thread at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/byte_stream.h"

namespace hermite::frame {

// Of N values that are not negative.
template <std::size_t N>
class FrameMean {
 public:
  void add(const std::array<double, N>& values) {
    const double kept = frames_ < kFrames ? 1 : (kFrames - 1) / kFrames;
    frames_ = kept * frames_ + 1;
    for (std::size_t i = 0; i < N; ++i) sums_[i] = kept * sums_[i] + values[i];
  }

  // Returns the weight of the frames so far; 0: none.
  double frames() const { return frames_; }
  // Returns the weighted sum of a value.
  double sum(std::size_t value) const { return sums_[value]; }

  void save(ByteWriter& bytes) const {
    bytes.number(frames_);
    bytes.numbers(sums_.data(), N);
  }
  // The reader fails, saying that `what` is out of range, if a sum is negative or not finite.
  void restore(ByteReader& bytes, const char* what) {
    bytes.number(frames_);
    bytes.numbers(sums_.data(), N);
    const auto is_sum = [](double value) { return std::isfinite(value) && value >= 0; };
    bytes.require(
        is_sum(frames_) && frames_ <= kFrames && std::all_of(sums_.begin(), sums_.end(), is_sum),
        what);
  }

 private:
  static constexpr double kFrames = 100;
  double frames_ = 0;
  std::array<double, N> sums_{};
};

}  // namespace hermite::frame
