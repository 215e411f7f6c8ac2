#include "core/frame/sensor_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hermite::frame {

namespace {

// Pixel distances: near pixels share most of a Kinect's noise, far ones none of it.
constexpr int kNear_px = 2, kFar_px = 6, kFarthest_px = 8;

// Samples every fourth pixel in both directions, or at most this many per row: thousands determine
// a deviation to one or two per cent.
constexpr int kLeastEvery_px = 4, kInARow = 80;
constexpr std::size_t kLeastCount = 500;

// The share of smallest normal deviates that is kept, and their mean size. A second difference of
// independent values has six times their variance.
constexpr double kKept = 0.6, kMeanOfKept = 0.3965;

// Relative decrease from the far to the near variance: of white noise, where curved surfaces add to
// the far one, and of the Kinect noise that sequences are disturbed with (0.20 and 0.76 on the
// rendered room). Real Kinects have 0.85 (fr1) and 0.88 (redkitchen).
constexpr double kWhite = 0.20, kKinect = 0.76, kMostCorrelation = 1.25;

// Noise-free depth has no noise, but curved surfaces still need some filter width: with a quarter,
// the error on the rendered room is 0.19 mm instead of 0.37, but on small images with half of their
// depth it is 12 mm instead of 9.
constexpr double kLeastScale = 0.5, kMostScale = 4;

// Size of second differences over `lag` pixels in both directions, in standard deviations of the
// model.
class Differences {
 public:
  Differences(const DepthImage& depth, double units_per_metre, const FrameOptions& options)
      : depth_(depth), units_per_metre_(units_per_metre), options_(options) {}

  double deviation(int lag) {
    sizes_.clear();
    const int every_px = std::max(kLeastEvery_px, depth_.width / kInARow);
    for (int y = kFarthest_px; y < depth_.height - kFarthest_px; y += every_px)
      for (int x = kFarthest_px; x < depth_.width - kFarthest_px; x += every_px) {
        add(x, y, lag, 0);
        add(x, y, 0, lag);
      }
    if (sizes_.size() < kLeastCount) return -1;
    const auto kept =
        sizes_.begin() + static_cast<std::ptrdiff_t>(kKept * static_cast<double>(sizes_.size()));
    std::nth_element(sizes_.begin(), kept, sizes_.end());
    std::sort(sizes_.begin(), kept);  // fixes the order of the sum
    double sum = 0;
    for (auto size = sizes_.begin(); size != kept; ++size) sum += double{*size};
    return sum / static_cast<double>(kept - sizes_.begin()) / kMeanOfKept / std::sqrt(6.0);
  }

 private:
  double depth_m(int x, int y) const {
    const double depth_m = depth_.at(x, y) / units_per_metre_;
    return depth_m >= options_.depth_min_m && depth_m <= options_.depth_max_m ? depth_m : 0;
  }

  void add(int x, int y, int dx, int dy) {
    const double centre_m = depth_m(x, y), before_m = depth_m(x - dx, y - dy),
                 after_m = depth_m(x + dx, y + dy);
    if (std::min({centre_m, before_m, after_m}) <= 0) return;
    const double noise_per_m = model_deviation_m(options_, centre_m) / (centre_m * centre_m);
    sizes_.push_back(
        static_cast<float>(std::abs(1 / before_m + 1 / after_m - 2 / centre_m) / noise_per_m));
  }

  const DepthImage& depth_;
  const double units_per_metre_;
  const FrameOptions& options_;
  std::vector<float> sizes_;
};

}  // namespace

double model_deviation_m(const FrameOptions& options, double depth_m) {
  const double beyond_m = std::max(0.0, depth_m - 0.4);
  return options.noise_floor_m + options.noise_growth_per_m * beyond_m * beyond_m;
}

NoiseSample measure_noise(const DepthImage& depth, double units_per_metre,
                          const FrameOptions& options) {
  Differences differences(depth, units_per_metre, options);
  const double near = differences.deviation(kNear_px), far = differences.deviation(kFar_px),
               farthest = differences.deviation(kFarthest_px);
  if (std::min({near, far, farthest}) < 0) return {};
  // The part caused by curvature grows with the square of the distance, noise does not.
  constexpr double kGrowth = (kFarthest_px * kFarthest_px) / double{kFar_px * kFar_px};
  const double bent2 = (farthest * farthest - far * far) / (kGrowth * kGrowth - 1);
  return {true, near, std::sqrt(std::max(far * far - bent2, near * near))};
}

void SensorNoise::add(const NoiseSample& sample) {
  if (sample.is_known) squares_.add({sample.near * sample.near, sample.far * sample.far});
}

double SensorNoise::scale() const {
  return squares_.frames() > 0
             ? std::clamp(std::sqrt(squares_.sum(1) / squares_.frames()), kLeastScale, kMostScale)
             : 1;
}

double SensorNoise::correlation() const {
  if (squares_.sum(1) <= 0) return 0;
  return std::clamp((1 - squares_.sum(0) / squares_.sum(1) - kWhite) / (kKinect - kWhite), 0.0,
                    kMostCorrelation);
}

void SensorNoise::restore(ByteReader& bytes) {
  squares_.restore(bytes, "the sensor's noise is out of range");
}

// Noise that correlates over some pixels is only averaged out by a wider spatial window, and only
// if the filter admits neighbours whose errors differ: with such noise the width in depth doubles.
FilterWidths filter_widths(const FrameOptions& options, const SensorNoise& noise) {
  if (!options.measure_noise)
    return {options.bilateral_sigma_space_px, options.bilateral_noise_sigmas};
  const double correlation = noise.correlation();
  return {options.bilateral_sigma_space_px + correlation * (options.bilateral_correlated_space_px -
                                                            options.bilateral_sigma_space_px),
          options.bilateral_noise_sigmas * noise.scale() * (1 + correlation)};
}

}  // namespace hermite::frame
