#include "core/disturb/depth_noise.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/base/image.h"
#include "core/dataset/changed_sequence.h"
#include "core/disturb/depth_units.h"
#include "core/disturb/key_values.h"
#include "core/math/counted_random.h"

namespace hermite::disturb {
namespace {

constexpr double kMaxSigma_mm = 200;
constexpr double kKinectFocalTimesBaseline_px_m = 525.0 * 0.075;
constexpr double kKinectLateralSigma_px = 0.5;
constexpr double kKinectDisparitySigma_px = 1.0 / 18.0;
// Side of the block of pixels that shares a random number. The means are correlated by 1 - lag /
// side in each direction.
constexpr int kKinectBlock_px = 5;
constexpr double kKinectMinDepth_m = 0.4, kKinectMaxDepth_m = 5.0;

// Returns the depth that the sensor's triangulation would report; 0 outside its range.
double kinect_depth_m(double true_depth_m, double normal, double steps_per_px) {
  if (true_depth_m <= 0) return 0;
  const double disparity_px =
      kKinectFocalTimesBaseline_px_m / true_depth_m + kKinectDisparitySigma_px * normal;
  const double rounded_px = std::round(disparity_px * steps_per_px) / steps_per_px;
  if (rounded_px <= 0) return 0;
  const double depth_m = kKinectFocalTimesBaseline_px_m / rounded_px;
  return depth_m >= kKinectMinDepth_m && depth_m <= kKinectMaxDepth_m ? depth_m : 0;
}

int shifted(int position, double normal, int side) {
  return std::clamp(position + static_cast<int>(std::lround(kKinectLateralSigma_px * normal)), 0,
                    side - 1);
}

// Random numbers for a pixel of a Kinect's image, each of unit variance.
struct KinectDraws {
  double right = 0, down = 0, disparity = 0;

  KinectDraws& operator+=(const KinectDraws& other) {
    right += other.right;
    down += other.down;
    disparity += other.disparity;
    return *this;
  }
};

// Returns random numbers that are all independent.
Image<KinectDraws> white_draws(int width, int height, std::uint64_t key) {
  Image<KinectDraws> draws(width, height);
  for (std::size_t i = 0; i < draws.pixels.size(); ++i) {
    const NormalPair shift = normal_pair(key, 2 * i);
    draws.pixels[i] = {shift.a, shift.b, normal_pair(key, 2 * i + 1).a};
  }
  return draws;
}

// Returns sums over a block of independent random numbers, divided by the square root of their
// count.
Image<KinectDraws> block_draws(int width, int height, std::uint64_t key) {
  const Image<KinectDraws> white =
      white_draws(width + kKinectBlock_px - 1, height + kKinectBlock_px - 1, key);
  Image<KinectDraws> rows(width, white.height), blocks(width, height);
  for (int y = 0; y < rows.height; ++y)
    for (int x = 0; x < width; ++x)
      for (int i = 0; i < kKinectBlock_px; ++i) rows.at(x, y) += white.at(x + i, y);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      KinectDraws& sum = blocks.at(x, y);
      for (int i = 0; i < kKinectBlock_px; ++i) sum += rows.at(x, y + i);
      sum = {sum.right / kKinectBlock_px, sum.down / kKinectBlock_px,
             sum.disparity / kKinectBlock_px};
    }
  return blocks;
}

DepthImage add_kinect_noise(const DepthImage& depth, double units_per_metre,
                            const Image<KinectDraws>& draws, double steps_per_px) {
  DepthImage noisy(depth.width, depth.height);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const KinectDraws& drawn = draws.at(x, y);
      const std::uint16_t seen =
          depth.at(shifted(x, drawn.right, depth.width), shifted(y, drawn.down, depth.height));
      noisy.at(x, y) = to_depth_units(
          kinect_depth_m(seen / units_per_metre, drawn.disparity, steps_per_px), units_per_metre);
    }
  return noisy;
}

DepthImage add_gaussian_noise(const DepthImage& depth, double units_per_metre, double sigma_m,
                              std::uint64_t key) {
  DepthImage noisy(depth.width, depth.height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    if (depth.pixels[i] > 0)
      noisy.pixels[i] = to_depth_units(
          depth.pixels[i] / units_per_metre + sigma_m * normal_pair(key, 2 * i).a, units_per_metre);
  return noisy;
}

class NoisySequence : public dataset::ChangedSequence {
 public:
  NoisySequence(std::unique_ptr<dataset::Sequence> clean, const NoiseOptions& options)
      : dataset::ChangedSequence(std::move(clean)), options_(options) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (frame.ok()) frame->depth = add_noise(frame->depth, camera(), options_, index);
    return frame;
  }

 private:
  const NoiseOptions options_;
};

}  // namespace

Result<NoiseOptions> parse_noise(const std::string& text) {
  const std::size_t comma = std::min(text.find(','), text.size());
  const std::string model = text.substr(0, comma);
  NoiseOptions options;
  if (model == "gaussian")
    options.model = NoiseModel::kGaussian;
  else if (model == "kinect")
    options.model = NoiseModel::kKinect;
  else if (model == "kinect-white")
    options.model = NoiseModel::kKinectWhite;
  else if (model != "none")
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("noise is \"{}\", allowed is none, gaussian, kinect or kinect-white", model)};
  double sigma_mm = options.sigma_m * 1000;
  std::vector<KeyValueRule> rules = {seed_rule(options.seed)};
  if (options.model == NoiseModel::kGaussian)
    rules.push_back(number_rule("sigma_mm", 0, kMaxSigma_mm, sigma_mm));
  if (options.model == NoiseModel::kKinect || options.model == NoiseModel::kKinectWhite)
    rules.push_back(number_rule("steps_per_px", 1, 64, options.steps_per_px));
  const Status status =
      apply_key_values(std::string_view(text).substr(std::min(comma + 1, text.size())), rules);
  if (!status.ok()) return in_context("noise " + model, status.error());
  options.sigma_m = sigma_mm / 1000;
  return options;
}

DepthImage add_noise(const DepthImage& depth, const Camera& camera, const NoiseOptions& options,
                     std::int64_t frame_index) {
  const double scale = camera.depth_units_per_metre;
  const std::uint64_t key = frame_key(options.seed, frame_index);
  switch (options.model) {
    case NoiseModel::kNone: break;
    case NoiseModel::kGaussian: return add_gaussian_noise(depth, scale, options.sigma_m, key);
    case NoiseModel::kKinect:
      return add_kinect_noise(depth, scale, block_draws(depth.width, depth.height, key),
                              options.steps_per_px);
    case NoiseModel::kKinectWhite:
      return add_kinect_noise(depth, scale, white_draws(depth.width, depth.height, key),
                              options.steps_per_px);
  }
  return depth;
}

std::unique_ptr<dataset::Sequence> with_noise(std::unique_ptr<dataset::Sequence> sequence,
                                              const NoiseOptions& options) {
  if (options.model == NoiseModel::kNone) return sequence;
  return std::make_unique<NoisySequence>(std::move(sequence), options);
}

}  // namespace hermite::disturb
