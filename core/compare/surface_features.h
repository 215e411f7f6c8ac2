// Descriptors of the shape and colour around places of a surface, by which two scans are recognised
// as one place without their images. Pure functions.
//
// The shape is described by fast point feature histograms (Rusu, Blodow, Beetz, "Fast point feature
// histograms (FPFH) for 3D registration", ICRA 2009), the colour by a histogram of chromaticity,
// which exposure and shading change little.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/compare/compared_scan.h"

namespace hermite::compare {

inline constexpr int kShapeBins = 33, kColorBins = 25;
using SurfaceDescriptor = Eigen::Matrix<float, kShapeBins + kColorBins, 1>;

struct SurfaceFeature {
  std::uint32_t sample = 0;  // index of the sample in the middle
  SurfaceDescriptor descriptor = SurfaceDescriptor::Zero();
};

// Returns the features of at most `most` samples: those that differ most from the mean of all, in
// ascending order of samples. `reach_m` is the radius of what a descriptor covers. Colours count
// only with `with_color`. Uses all processors; the result does not depend on them.
std::vector<SurfaceFeature> surface_features(std::span<const SurfaceSample> samples, double reach_m,
                                             std::size_t most, bool with_color);

// A feature of each scan that look alike.
struct FeaturePair {
  std::uint32_t sample_a = 0, sample_b = 0;
};

// Returns for each feature of B the `count` features of A that are most similar, in the order of
// B's features.
std::vector<FeaturePair> similar_features(std::span<const SurfaceFeature> a,
                                          std::span<const SurfaceFeature> b, std::size_t count);

}  // namespace hermite::compare
