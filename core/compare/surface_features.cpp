#include "core/compare/surface_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/parallel.h"
#include "core/compare/sample_grid.h"

namespace hermite::compare {

namespace {

using Eigen::Vector3d;

constexpr int kAngleBins = 11;  // for each of the three angles, as in the paper
constexpr int kChromaBins = 5;  // for red and for green, as shares of all light
// Chromaticity of indoor surfaces lies around a third; shares outside this range are clamped to it.
constexpr double kLeastChroma = 0.2, kMostChroma = 0.5;
constexpr float kColorWeight = 0.7f;
using ShapeHistogram = std::array<float, kShapeBins>;

int bin_of(double value, double low, double high) {
  return std::clamp(static_cast<int>(kAngleBins * (value - low) / (high - low)), 0, kAngleBins - 1);
}

// The three angles between the normals of two places and the line between them, in the paper's
// Darboux frame.
void add_pair(const SurfaceSample& first, const SurfaceSample& second, ShapeHistogram& histogram) {
  Vector3d between = second.position_m - first.position_m;
  const double distance_m = between.norm();
  if (distance_m < 1e-9) return;
  between /= distance_m;
  const bool swap = std::abs(first.normal.dot(between)) < std::abs(second.normal.dot(between));
  const Vector3d& u = swap ? second.normal : first.normal;
  const Vector3d& other = swap ? first.normal : second.normal;
  if (swap) between = -between;
  Vector3d v = u.cross(between);
  const double length = v.norm();
  if (length < 1e-6) return;
  v /= length;
  const Vector3d w = u.cross(v);
  const std::array<int, 3> bins{bin_of(v.dot(other), -1, 1), bin_of(u.dot(between), -1, 1),
                                bin_of(std::atan2(w.dot(other), u.dot(other)), -M_PI, M_PI)};
  for (std::size_t i = 0; i < bins.size(); ++i)
    histogram[i * kAngleBins + static_cast<std::size_t>(bins[i])] += 1;
}

void add_color(const Vector3d& color, SurfaceDescriptor& descriptor) {
  const double sum = color.sum() + 1;
  const auto bin = [&](double value) {
    return std::clamp(
        static_cast<int>(kChromaBins * (value / sum - kLeastChroma) / (kMostChroma - kLeastChroma)),
        0, kChromaBins - 1);
  };
  descriptor[kShapeBins + kChromaBins * bin(color.x()) + bin(color.y())] += 1;
}

void normalise(SurfaceDescriptor& descriptor, bool with_color) {
  for (int angle = 0; angle < 3; ++angle) {
    auto part = descriptor.segment<kAngleBins>(angle * kAngleBins);
    if (const float sum = part.sum(); sum > 0) part /= sum;
  }
  auto color = descriptor.tail<kColorBins>();
  if (const float sum = color.sum(); with_color && sum > 0)
    color *= kColorWeight / sum;
  else
    color.setZero();
}

std::vector<std::uint32_t> most_different(const std::vector<SurfaceDescriptor>& descriptors,
                                          std::size_t most) {
  SurfaceDescriptor mean = SurfaceDescriptor::Zero();
  for (const SurfaceDescriptor& descriptor : descriptors) mean += descriptor;
  mean /= static_cast<float>(std::max<std::size_t>(descriptors.size(), 1));
  std::vector<std::uint32_t> order(descriptors.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto difference = [&](std::uint32_t i) { return (descriptors[i] - mean).squaredNorm(); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return difference(i) > difference(j); });
  order.resize(std::min(order.size(), most));
  std::sort(order.begin(), order.end());
  return order;
}

std::vector<ShapeHistogram> simple_histograms(std::span<const SurfaceSample> samples,
                                              const SampleGrid& grid, double reach_m) {
  std::vector<ShapeHistogram> histograms(samples.size());
  in_parallel(samples.size(), [&](std::size_t i) {
    histograms[i].fill(0);
    grid.for_each_within(samples[i].position_m, reach_m, [&](std::uint32_t j) {
      if (j != i) add_pair(samples[i], samples[j], histograms[i]);
    });
    const float sum =
        std::accumulate(histograms[i].begin(), histograms[i].begin() + kAngleBins, 0.0f);
    if (sum > 0)
      for (float& value : histograms[i]) value /= sum;
  });
  return histograms;
}

}  // namespace

std::vector<SurfaceFeature> surface_features(std::span<const SurfaceSample> samples, double reach_m,
                                             std::size_t most, bool with_color) {
  const SampleGrid grid(samples, reach_m);
  const std::vector<ShapeHistogram> simple = simple_histograms(samples, grid, reach_m);
  std::vector<SurfaceDescriptor> descriptors(samples.size());
  in_parallel(samples.size(), [&](std::size_t i) {
    SurfaceDescriptor& descriptor = descriptors[i];
    descriptor.setZero();
    grid.for_each_within(samples[i].position_m, reach_m, [&](std::uint32_t j) {
      const double distance_m = (samples[j].position_m - samples[i].position_m).norm();
      const auto weight = static_cast<float>(reach_m / (distance_m + reach_m / 8));
      for (int bin = 0; bin < kShapeBins; ++bin)
        descriptor[bin] += weight * simple[j][static_cast<std::size_t>(bin)];
      add_color(samples[j].color, descriptor);
    });
    normalise(descriptor, with_color);
  });
  std::vector<SurfaceFeature> features;
  for (const std::uint32_t sample : most_different(descriptors, most))
    features.push_back({sample, descriptors[sample]});
  return features;
}

std::vector<FeaturePair> similar_features(std::span<const SurfaceFeature> a,
                                          std::span<const SurfaceFeature> b, std::size_t count) {
  count = std::min(count, a.size());
  std::vector<FeaturePair> pairs(count * b.size());
  in_parallel(b.size(), [&](std::size_t i) {
    std::vector<std::pair<float, std::uint32_t>> distances;
    distances.reserve(a.size());
    for (const SurfaceFeature& feature : a)
      distances.emplace_back((feature.descriptor - b[i].descriptor).squaredNorm(), feature.sample);
    std::partial_sort(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(count),
                      distances.end());
    for (std::size_t k = 0; k < count; ++k)
      pairs[i * count + k] = {distances[k].second, b[i].sample};
  });
  return pairs;
}

}  // namespace hermite::compare
