#include "core/track/lens_shading.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/math/rigid3_fields.h"

namespace hermite {

namespace {

// Grey values between which a sensor answers in proportion, and steps of grey to the next pixel beyond which a shift decides.
constexpr float kDarkest = 20, kBrightest = 240, kSteepest = 12;

// A place is the same within so much; a coarse pixel is two centimetres at 1.5 m.
constexpr double kSame_m = 0.02, kSameGrowth_per_m = 0.01;

// Logarithms of grey differ by this where nothing but noise does; neighbours share their errors, so fifty count as one.
constexpr double kDeviation = 0.05, kPixelsThatCountAsOne = 50;

// Before anything is seen, corners are as dark as this in half of all cases (in logarithms): most cameras of phones and Kinects.
constexpr double kPriorDeviation = 0.5;

// What must be known of the corners before it is used, in standard deviations.
constexpr double kSignificant = 4;

// Twenty seconds of full views; what is older counts half, so that a lens that is changed is learned again.
constexpr double kMostWeight = 2e6;

// Another view is taken to compare with when less than this is seen of it.
constexpr double kLeastCompared = 0.4;

constexpr double kDarkestCorner = 0.2;

// Half a step of a bright grey value.
constexpr float kChangeThatShows = 0.002f;

using Basis = Eigen::Vector3d;
Basis basis(double squared_distance) {
  return {squared_distance, squared_distance * squared_distance, squared_distance * squared_distance * squared_distance};
}

double squared_distance(const shared::Intrinsics& camera, double x, double y) {
  const double cx = camera.cx, cy = camera.cy;
  const double farthest_x = std::max(cx, camera.width - 1 - cx), farthest_y = std::max(cy, camera.height - 1 - cy);
  return std::min(1.0, ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (farthest_x * farthest_x + farthest_y * farthest_y));
}

bool is_even(const CoarseView& view, int x, int y) {
  const float grey = view.grey[view.index(x, y)];
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
    if (!view.contains(x + dx, y + dy) || std::abs(view.grey[view.index(x + dx, y + dy)] - grey) > kSteepest) return false;
  return true;
}

bool is_in_proportion(float grey) { return grey >= kDarkest && grey <= kBrightest; }

struct Pair {
  Basis basis;
  double log_ratio;
};

}  // namespace

std::uint8_t shading_index(const shared::Intrinsics& camera, double x, double y) {
  return static_cast<std::uint8_t>(std::lround(255 * squared_distance(camera, x, y)));
}

LensShading::LensShading() { table_.fill(1); }

void LensShading::learn(const CoarseView& view, const Rigid3& world_from_camera, const CoarseMask& moving) {
  CoarseView raw = view;
  for (int y = 0; y < static_cast<int>(raw.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(raw.camera.width); ++x) raw.grey[raw.index(x, y)] *= table_[shading_index(raw.camera, x, y)];
  compared_share_ = 0;
  if (!earlier_.empty()) compare(raw, inverse(world_from_earlier_) * world_from_camera, moving);
  if (compared_share_ >= kLeastCompared) return;
  earlier_ = std::move(raw);
  for (std::size_t i = 0; i < moving.size(); ++i)
    if (moving[i] != 0) earlier_.depth_m[i] = 0;
  world_from_earlier_ = world_from_camera;
}

void LensShading::compare(const CoarseView& view, const Rigid3& earlier_from_now, const CoarseMask& moving) {
  std::vector<Pair> pairs;
  for (int y = 0; y < static_cast<int>(view.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view.camera.width); ++x) {
      const std::size_t i = view.index(x, y);
      if (view.depth_m[i] <= 0 || moving[i] != 0 || !is_in_proportion(view.grey[i]) || !is_even(view, x, y)) continue;
      const Eigen::Vector3d point = earlier_from_now * view.point(x, y);
      if (point.z() < 0.05) continue;
      const Eigen::Vector2d uv = earlier_.project(point);
      const int u = static_cast<int>(std::lround(uv.x())), v = static_cast<int>(std::lround(uv.y()));
      if (!earlier_.contains(u, v)) continue;
      const std::size_t j = earlier_.index(u, v);
      if (earlier_.depth_m[j] <= 0 || !is_in_proportion(earlier_.grey[j]) || !is_even(earlier_, u, v)) continue;
      const double apart_m = earlier_.normals[j].cast<double>().dot(point - earlier_.point(u, v));
      if (std::abs(apart_m) > kSame_m + kSameGrowth_per_m * point.z() * point.z()) continue;
      pairs.push_back({basis(squared_distance(view.camera, x, y)) - basis(squared_distance(earlier_.camera, u, v)),
                       std::log(static_cast<double>(view.grey[i]) / static_cast<double>(earlier_.grey[j]))});
    }
  compared_share_ = static_cast<double>(pairs.size()) / static_cast<double>(view.size());
  if (pairs.size() < 100) return;
  // The exposure of both frames is unknown: only what differs from the mean counts. Then outliers do not.
  double exposure = 0;
  for (int round = 0; round < 3; ++round) {
    double weight = 0, sum = 0;
    for (const Pair& pair : pairs) {
      const double residual = pair.log_ratio - pair.basis.dot(coefficients_);
      const double scaled = round == 0 ? 0 : (residual - exposure) / (4 * kDeviation), likely = 1 / (1 + scaled * scaled);
      weight += likely;
      sum += likely * residual;
    }
    exposure = sum / weight;
  }
  double weight = 0, mean_ratio = 0;
  Basis mean_basis = Basis::Zero();
  std::vector<double> weights;
  for (const Pair& pair : pairs) {
    const double scaled = (pair.log_ratio - pair.basis.dot(coefficients_) - exposure) / (4 * kDeviation);
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
  update_table();
}

void LensShading::update_table() {
  const double variance = kDeviation * kDeviation * kPixelsThatCountAsOne;
  const Eigen::Matrix3d information = information_ / variance + Eigen::Matrix3d::Identity() / (kPriorDeviation * kPriorDeviation);
  coefficients_ = information.ldlt().solve(right_hand_side_ / variance);
  const Basis corner = basis(1);
  const double deviation = std::sqrt(std::max(0.0, corner.dot(information.ldlt().solve(corner))));
  const bool is_known = coefficients_.dot(corner) < -kSignificant * deviation;
  ShadingTable table;
  double darkest = 1;
  float change = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double darkening = is_known ? std::exp(coefficients_.dot(basis(static_cast<double>(i) / 255))) : 1;
    // It gets darker outwards, or stays.
    darkest = std::clamp(darkening, kDarkestCorner, darkest);
    table[i] = static_cast<float>(darkest);
    change = std::max(change, std::abs(table[i] - table_[i]));
  }
  if (change > kChangeThatShows) table_ = table;
}

void LensShading::save(ByteWriter& bytes) const {
  hermite::save(bytes, earlier_);
  rigid3_fields(bytes, world_from_earlier_);
  bytes.number(compared_share_);
  bytes.numbers(information_.data(), 9);
  bytes.numbers(right_hand_side_.data(), 3);
  bytes.number(weight_);
  bytes.numbers(coefficients_.data(), 3);
  bytes.number(table_);
}

void LensShading::restore(ByteReader& bytes) {
  hermite::restore(bytes, earlier_);
  rigid3_fields(bytes, world_from_earlier_);
  bytes.number(compared_share_);
  bytes.numbers(information_.data(), 9);
  bytes.numbers(right_hand_side_.data(), 3);
  bytes.number(weight_);
  bytes.numbers(coefficients_.data(), 3);
  bytes.number(table_);
  const bool valid = information_.allFinite() && right_hand_side_.allFinite() && coefficients_.allFinite() && weight_ >= 0 &&
                     std::all_of(table_.begin(), table_.end(), [](float darkening) { return darkening > 0 && darkening <= 1; });
  bytes.require(valid, "the darkening of the lens");
}

}  // namespace hermite
