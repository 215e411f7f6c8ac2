#include "core/evaluate/depth_survey.h"

#include <fmt/core.h>

#include <array>
#include <numeric>

namespace hermite::evaluate {
namespace {

constexpr double kNearMedian_m = 0.3, kFarMedian_m = 6;
// Millimetres first, then by frequency of use: TUM's, 1/10 mm, RealSense's at close range, 1/256 m,
// centimetres.
constexpr std::array<double, 5> kCommonUnits = {1000, 5000, 10000, 256, 100};

bool is_plausible(double median_m) { return median_m >= kNearMedian_m && median_m <= kFarMedian_m; }

}  // namespace

void DepthValues::add(const DepthImage& depth) {
  for (const std::uint16_t value : depth.pixels) ++counts_[value];
}

DepthSurvey DepthValues::survey() const {
  DepthSurvey survey;
  const std::int64_t all = std::accumulate(counts_.begin(), counts_.end(), std::int64_t{0}),
                     valid = all - counts_[0];
  if (valid == 0) return survey;
  survey.valid_share = static_cast<double>(valid) / static_cast<double>(all);
  std::int64_t below = 0;
  for (std::uint32_t value = 1; value < counts_.size(); ++value) {
    if (counts_[value] == 0) continue;
    const auto at_quantile = [&](double quantile) {
      const auto rank = static_cast<std::int64_t>(quantile * static_cast<double>(valid));
      return below <= rank && rank < below + counts_[value];
    };
    if (at_quantile(0.01)) survey.nearest = static_cast<std::uint16_t>(value);
    if (at_quantile(0.50)) survey.median = static_cast<std::uint16_t>(value);
    if (at_quantile(0.99)) survey.farthest = static_cast<std::uint16_t>(value);
    below += counts_[value];
    ++survey.distinct_values;
    survey.common_divisor =
        static_cast<std::uint16_t>(std::gcd<unsigned, unsigned>(survey.common_divisor, value));
  }
  return survey;
}

UnitGuess guess_depth_unit(const DepthSurvey& survey, double stated) {
  if (survey.median == 0) return {stated, "there is no depth to tell it from", true};
  const double stated_m = survey.median / stated;
  const bool fives = survey.common_divisor % 5 == 0 && survey.common_divisor > 0;
  const std::string steps =
      fives ? fmt::format("; every value is a multiple of {}, as millimetres in fifths are",
                          survey.common_divisor)
            : "";
  const std::string half = "half of the depth is nearer than ";
  if (is_plausible(stated_m))
    return {stated,
            fmt::format("{}{:.3g} m in the stated unit, as in rooms{}", half, stated_m, steps),
            false};
  for (const double units : kCommonUnits)
    if (is_plausible(survey.median / units))
      return {units,
              fmt::format("{}{:.3g} m in the stated unit of {:.3g} a metre, which no room is; "
                          "{:.3g} a metre would make it {:.3g} m{}",
                          half, stated_m, stated, units, survey.median / units, steps),
              true};
  return {stated,
          fmt::format("{}{:.3g} m in the stated unit, and no usual unit makes that a room", half,
                      stated_m),
          true};
}

}  // namespace hermite::evaluate
