#include "core/frame/depth_steps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace hermite::frame {

namespace {

// Every second pixel in both directions.
constexpr int kEvery_px = 2;

// Beyond the distance over which a Kinect's noise is correlated.
constexpr int kApart_px = 8;

// Fewer values or comparisons do not tell: those of two walls seen at right angles are no steps of
// the sensor.
constexpr std::size_t kLeastValues = 16, kLeastCompared = 300;

// Of the gaps between values that occur, steps are the least, since surfaces have gaps, too.
constexpr double kLeastGaps = 0.25;

// The share of pixels between two on the same step that are on another one: 0.39 with noise of 0.44
// steps, as a Kinect has, 0.28, 0.17 and 0.07 with 0.33, 0.22 and 0.11 steps; recordings of Kinects
// have 0.38 to 0.48. What a mean keeps of the steps is exp(-2 pi^2 s^2) for noise of s steps (Gray,
// Stockham 1993, Dithered quantizers): 0.02, 0.11, 0.38 and 0.78 there, which is about (1 - share /
// 0.45)^2.
constexpr double kAveraged = 0.45;

struct Values {
  std::vector<std::pair<std::uint16_t, std::uint32_t>> counts;  // in increasing order, without 0
  double median = 0;
};

Values values_of(const DepthImage& depth) {
  std::vector<std::uint32_t> count(65536, 0);
  std::uint32_t all = 0;
  for (int y = 0; y < depth.height; y += kEvery_px)
    for (int x = 0; x < depth.width; x += kEvery_px) {
      const std::uint16_t value = depth.at(x, y);
      count[value] += value > 0 ? 1 : 0;
      all += value > 0 ? 1 : 0;
    }
  Values values;
  std::uint32_t below = 0;
  for (std::uint32_t value = 1; value < count.size(); ++value) {
    if (count[value] == 0) continue;
    values.counts.emplace_back(static_cast<std::uint16_t>(value), count[value]);
    if (2 * below <= all) values.median = value;
    below += count[value];
  }
  return values;
}

// Returns the step in inverse depth, from the gaps between values, each as often as the rarer of
// both occurs.
double step_of(const Values& values) {
  std::vector<std::pair<double, std::uint32_t>> gaps;
  double all = 0;
  for (std::size_t i = 1; i < values.counts.size(); ++i) {
    const auto& [nearer, near_count] = values.counts[i - 1];
    const auto& [farther, far_count] = values.counts[i];
    gaps.emplace_back(1.0 / nearer - 1.0 / farther, std::min(near_count, far_count));
    all += gaps.back().second;
  }
  std::sort(gaps.begin(), gaps.end());
  double below = 0;
  for (const auto& [gap, count] : gaps) {
    below += count;
    if (below >= kLeastGaps * all) return gap;
  }
  return 0;
}

// Returns the share of pixels between two on the same step that are not; -1: too few.
double share_between(const DepthImage& depth) {
  std::size_t compared = 0, different = 0;
  const auto add = [&](int x, int y, int dx, int dy) {
    const std::uint16_t before = depth.at(x - dx, y - dy), here = depth.at(x, y),
                        after = depth.at(x + dx, y + dy);
    if (before == 0 || here == 0 || before != after) return;
    ++compared;
    different += here != before ? 1 : 0;
  };
  for (int y = kApart_px; y < depth.height - kApart_px; y += kEvery_px)
    for (int x = kApart_px; x < depth.width - kApart_px; x += kEvery_px) {
      add(x, y, kApart_px, 0);
      add(x, y, 0, kApart_px);
    }
  return compared >= kLeastCompared ? static_cast<double>(different) / static_cast<double>(compared)
                                    : -1;
}

}  // namespace

DepthSteps measure_steps(const DepthImage& depth, double units_per_metre) {
  const Values values = values_of(depth);
  const double share = share_between(depth);
  if (values.counts.size() < kLeastValues || share < 0) return {};
  const double step_m = step_of(values) * values.median * values.median / units_per_metre;
  const double kept = std::max(0.0, 1 - share / kAveraged);
  return {values.median / units_per_metre, step_m, step_m * kept * kept};
}

void SeenSteps::add(const DepthSteps& frame) {
  if (frame.step_m > 0) of_frames_.add({frame.depth_m, frame.step_m, frame.terrace_m});
}

DepthSteps SeenSteps::mean() const {
  const double frames = of_frames_.frames();
  if (frames <= 0) return {};
  return {of_frames_.sum(0) / frames, of_frames_.sum(1) / frames, of_frames_.sum(2) / frames};
}

void SeenSteps::restore(ByteReader& bytes) {
  of_frames_.restore(bytes, "the steps of depth are out of range");
  bytes.require(of_frames_.frames() <= 0 || of_frames_.sum(0) > 0, "steps of depth at no depth");
}

}  // namespace hermite::frame
