#include "core/track/lens_shading.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace hermite::track {

namespace {

// Range of grey values in which a sensor responds proportionally, and the largest grey difference
// to the next pixel; beyond it a small misalignment dominates.
constexpr float kDarkest = 20, kBrightest = 240, kSteepest = 12;

// Standard deviation of the logarithm of grey values by noise; errors of neighbours are correlated,
// so fifty pixels count as one.
constexpr double kDeviation = 0.05, kPixelsThatCountAsOne = 50;

// Prior: before anything is seen, the standard deviation of the corners' darkening, as a logarithm,
// from experience with most cameras of phones and Kinects.
constexpr double kPriorDeviation = 0.5;

// The shading is used once the darkening of the corners is significant by this many standard
// deviations.
constexpr double kSignificant = 4;

// Twenty seconds of full views; then the weight of the past is halved, so that the shading of
// another lens is learned.
constexpr double kMostWeight = 2e6;

constexpr double kDarkestCorner = 0.2;

// Half a step of a bright grey value.
constexpr float kChangeThatShows = 0.002f;

using Basis = Eigen::Vector3d;
Basis basis(double squared_distance) {
  return {squared_distance, squared_distance * squared_distance,
          squared_distance * squared_distance * squared_distance};
}

bool is_even(const frame::CoarseView& view, int x, int y) {
  const float grey = view.grey[view.index(x, y)];
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
    if (!view.contains(x + dx, y + dy) ||
        std::abs(view.grey[view.index(x + dx, y + dy)] - grey) > kSteepest)
      return false;
  return true;
}

bool is_in_proportion(float grey) { return grey >= kDarkest && grey <= kBrightest; }

struct Pair {
  Basis basis;
  double log_ratio;
};

}  // namespace

std::uint8_t shading_index(const shared::Intrinsics& camera, double x, double y) {
  return static_cast<std::uint8_t>(std::lround(255 * squared_image_distance(camera, x, y)));
}

LensShading::LensShading() { table_.fill(1); }

std::vector<float> LensShading::of_pixels(const shared::Intrinsics& camera) const {
  std::vector<float> factors;
  for (std::uint32_t y = 0; y < camera.height; ++y)
    for (std::uint32_t x = 0; x < camera.width; ++x)
      factors.push_back(table_[shading_index(camera, x, y)]);
  return factors;
}

frame::CoarseView LensShading::as_measured(frame::CoarseView view) const {
  for (int y = 0; y < static_cast<int>(view.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view.camera.width); ++x)
      view.grey[view.index(x, y)] *= table_[shading_index(view.camera, x, y)];
  return view;
}

bool LensShading::learn(const frame::CoarseView& now, const EarlierView::Comparison& comparison) {
  const frame::CoarseView& earlier = comparison.earlier;
  std::vector<Pair> pairs;
  for (const auto& [x, y, u, v] : comparison.places) {
    const float grey = now.grey[now.index(x, y)], earlier_grey = earlier.grey[earlier.index(u, v)];
    if (!is_in_proportion(grey) || !is_in_proportion(earlier_grey) || !is_even(now, x, y) ||
        !is_even(earlier, u, v))
      continue;
    pairs.push_back({basis(squared_image_distance(now.camera, x, y)) -
                         basis(squared_image_distance(earlier.camera, u, v)),
                     std::log(static_cast<double>(grey) / static_cast<double>(earlier_grey))});
  }
  if (pairs.size() < 100) return false;
  // The exposure of both frames is unknown, so only differences from the robust mean are used. Then
  // outliers have little influence.
  double exposure = 0;
  for (int round = 0; round < 3; ++round) {
    double weight = 0, sum = 0;
    for (const Pair& pair : pairs) {
      const double residual = pair.log_ratio - pair.basis.dot(coefficients_);
      const double scaled = round == 0 ? 0 : (residual - exposure) / (4 * kDeviation),
                   likely = 1 / (1 + scaled * scaled);
      weight += likely;
      sum += likely * residual;
    }
    exposure = sum / weight;
  }
  double weight = 0, mean_ratio = 0;
  Basis mean_basis = Basis::Zero();
  std::vector<double> weights;
  for (const Pair& pair : pairs) {
    const double scaled =
        (pair.log_ratio - pair.basis.dot(coefficients_) - exposure) / (4 * kDeviation);
    weights.push_back(1 / (1 + scaled * scaled));
    weight += weights.back();
    mean_basis += weights.back() * pair.basis;
    mean_ratio += weights.back() * pair.log_ratio;
  }
  mean_basis /= weight;
  mean_ratio /= weight;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Basis difference = pairs[i].basis - mean_basis;
    information_ += weights[i] * difference * difference.transpose();
    right_hand_side_ += weights[i] * difference * (pairs[i].log_ratio - mean_ratio);
  }
  weight_ += weight;
  if (weight_ > kMostWeight) {
    weight_ *= 0.5;
    information_ *= 0.5;
    right_hand_side_ *= 0.5;
  }
  return update_table();
}

bool LensShading::update_table() {
  const double variance = kDeviation * kDeviation * kPixelsThatCountAsOne;
  const Eigen::Matrix3d information =
      information_ / variance + Eigen::Matrix3d::Identity() / (kPriorDeviation * kPriorDeviation);
  coefficients_ = information.ldlt().solve(right_hand_side_ / variance);
  const Basis corner = basis(1);
  const double deviation = std::sqrt(std::max(0.0, corner.dot(information.ldlt().solve(corner))));
  const bool is_known = coefficients_.dot(corner) < -kSignificant * deviation;
  ShadingTable table;
  double darkest = 1;
  float change = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double darkening =
        is_known ? std::exp(coefficients_.dot(basis(static_cast<double>(i) / 255))) : 1;
    // The darkening never decreases outwards.
    darkest = std::clamp(darkening, kDarkestCorner, darkest);
    table[i] = static_cast<float>(darkest);
    change = std::max(change, std::abs(table[i] - table_[i]));
  }
  if (change <= kChangeThatShows) return false;
  table_ = table;
  return true;
}

void LensShading::save(ByteWriter& bytes) const {
  bytes.numbers(information_.data(), 9);
  bytes.numbers(right_hand_side_.data(), 3);
  bytes.number(weight_);
  bytes.numbers(coefficients_.data(), 3);
  bytes.number(table_);
}

void LensShading::restore(ByteReader& bytes) {
  bytes.numbers(information_.data(), 9);
  bytes.numbers(right_hand_side_.data(), 3);
  bytes.number(weight_);
  bytes.numbers(coefficients_.data(), 3);
  bytes.number(table_);
  const bool valid = information_.allFinite() && right_hand_side_.allFinite() &&
                     coefficients_.allFinite() && weight_ >= 0 &&
                     std::all_of(table_.begin(), table_.end(),
                                 [](float darkening) { return darkening > 0 && darkening <= 1; });
  bytes.require(valid, "the darkening of the lens");
}

}  // namespace hermite::track
