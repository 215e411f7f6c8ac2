// How well two scans agree when one is placed in the other: what both saw at the same place, and
// what one saw where the other one looked through. Pure functions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/compare/compared_scan.h"
#include "core/compare/sample_grid.h"
#include "core/compare/sight.h"
#include "core/math/rigid3.h"

namespace hermite::compare {

// The samples by which two scans are registered: a hundredth of the smaller scan's extent apart,
// within these limits, and farther in scans with more than kMostCoarseSamples of them.
inline constexpr double kLeastCoarseSpacing_m = 0.01, kMostCoarseSpacing_m = 0.05;
inline constexpr std::size_t kMostCoarseSamples = 20'000;
double coarse_spacing_m(const ComparedScan& a, const ComparedScan& b);

// A scan with what is needed to place it. Refers to the scan, which must outlive it. Const and
// thread-safe.
class CoarseScan {
 public:
  CoarseScan(const ComparedScan& scan, double spacing_m);
  CoarseScan(const CoarseScan&) = delete;
  CoarseScan& operator=(const CoarseScan&) = delete;

  const ComparedScan& scan() const { return scan_; }
  std::span<const SurfaceSample> samples() const { return samples_.samples; }
  const SampleGrid& grid() const { return grid_; }
  const Sight& sight() const { return sight_; }
  double spacing_m() const { return samples_.spacing_m; }

 private:
  const ComparedScan& scan_;
  const SurfaceSamples samples_;
  const SampleGrid grid_;
  const Sight sight_;
};

struct CoarseAgreement {
  std::size_t sample_count = 0;  // of both scans
  std::size_t matched = 0;       // have the other scan's surface at their place
  // Lie where the other scan looked through; the rest was not seen by the other.
  std::size_t contradicted = 0;
  std::size_t matched_a = 0, samples_a = 0, matched_b = 0, samples_b = 0;
  // Median difference of the colours of matched samples, 0 to 255, after a gain for each channel.
  double color_difference = 0;
  bool has_color = false;  // both scans have colours

  // Of what both saw, the share that agrees; 0 if nothing was seen by both.
  double share() const;
  // Share of the smaller scan that was found in the other one.
  double overlap() const;
};

CoarseAgreement agreement_of(const CoarseScan& a, const CoarseScan& b, const Rigid3& a_from_b);

}  // namespace hermite::compare
