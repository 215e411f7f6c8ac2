#include "core/calibrate/camera_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/calibrate/pair_agreement.h"
#include "core/calibrate/view_choice.h"

namespace hermite {
namespace {

// A tested parameter: its usual error, the standard deviation needed for a verdict, and the error
// from which on it counts as off. Usual errors are those of calibrate.cpp. In rendered scenes with
// Kinect noise, 12 to 40 views give deviations of 0.02 to 0.07 % of focal length and 0.01 to 0.03 %
// of bend, and values up to 0.21 and 0.09 % if nothing is off. If something else is wrong, as with
// redkitchen's sensor or fr1's shutter, the deviations are 0.25 to 1.6 % and 0.04 to 0.6 %.
struct Asked {
  CameraNumber number;
  double usual, known, off;
};
constexpr std::array<Asked, 2> kAsked{{{kFocal, 0.010, 0.0015, 0.004}, {kBend, 0.015, 0.0005, 0.003}}};

// An error must be this many standard deviations, and at most this many usual errors; beyond that
// it is not the camera's.
constexpr double kSignificant = 5, kMostUsual = 3;

// A half of the views may differ from the whole by half of the value, or by what is not significant
// in that half.
constexpr double kMostApart = 0.5, kMostApartDeviations = 3;

// For the held-out pairs, the least mean relative decrease of squared distances, and how many
// standard errors it must be. An error of 1 % of focal length gives 2.4 to 9 % with 16 views and
// more, at 4 to 12 standard errors; an undisturbed camera gives -0.4 to 0.3 %.
constexpr double kLeastMeanGain = 0.01, kLeastMeanGainErrors = 3;

constexpr std::size_t kLeastPairs = 24, kLeastPairsOfHalf = 12, kLeastPairsHeldBack = 6;

using FreeNumbers = std::array<bool, kCameraNumberCount>;

struct Question {
  const std::vector<CalibrationView>& views;
  const Camera& camera;
  const ChosenPairs pairs;

  JointSolution solve(const std::vector<ViewPair>& of, const FreeNumbers& is_free, const JointSolution* start) const {
    JointOptions options;
    options.is_free = is_free;
    for (const Asked& asked : kAsked) options.prior_deviation[static_cast<Eigen::Index>(asked.number)] = asked.usual;
    return adjust_jointly(views, of, camera, options, start);
  }
};

bool is_known(const JointSolution& solution) {
  return std::all_of(kAsked.begin(), kAsked.end(), [&solution](const Asked& asked) {
    const auto k = static_cast<Eigen::Index>(asked.number);
    return solution.deviation[k] <= asked.known && std::abs(solution.change[k]) <= kMostUsual * asked.usual;
  });
}

FreeNumbers numbers_off(const JointSolution& solution) {
  FreeNumbers is_off{};
  for (const auto& [number, usual, known, off] : kAsked) {
    const auto k = static_cast<Eigen::Index>(number);
    is_off[number] = std::abs(solution.change[k]) >= std::max(off, kSignificant * solution.deviation[k]);
  }
  return is_off;
}

bool halves_agree(const Question& question, const FreeNumbers& is_free, const JointSolution& all) {
  for (const bool is_second : {false, true}) {
    const std::vector<ViewPair> half = pairs_of_half(question.pairs.fitted, question.views.size(), is_second);
    if (half.size() < kLeastPairsOfHalf) return false;
    const JointSolution solution = question.solve(half, is_free, &all);
    for (const Asked& asked : kAsked) {
      const auto k = static_cast<Eigen::Index>(asked.number);
      const double allowed = std::max(kMostApart * std::abs(all.change[k]), kMostApartDeviations * solution.deviation[k]);
      if (is_free[asked.number] && std::abs(solution.change[k] - all.change[k]) > allowed) return false;
    }
  }
  return true;
}

bool pairs_gain(const Question& question, const JointSolution& as_it_was, const JointSolution& better) {
  const auto squares = [&question](const JointSolution& solution) {
    return squares_of(
        agreements_of(question.views, solution.world_from_camera, question.pairs.held_back, changed(question.camera, solution.change)));
  };
  const PairGain gain = gain_of(squares(as_it_was), squares(better));
  return gain.pair_count >= kLeastPairsHeldBack && gain.mean >= kLeastMeanGain && gain.mean >= kLeastMeanGainErrors * gain.standard_error;
}

}  // namespace

CameraCheck check_camera(const std::vector<CalibrationView>& views, const Camera& camera) {
  const Question question{views, camera, choose_pairs(views, camera)};
  if (question.pairs.fitted.size() < kLeastPairs || question.pairs.held_back.size() < kLeastPairsHeldBack) return {};
  FreeNumbers is_free{};
  for (const Asked& asked : kAsked) is_free[asked.number] = true;
  JointSolution found = question.solve(question.pairs.fitted, is_free, nullptr);
  if (!is_known(found)) return {};
  is_free = numbers_off(found);
  if (is_free == FreeNumbers{}) return {CameraVerdict::kFits};
  if (is_free[kFocal] != is_free[kBend]) {
    found = question.solve(question.pairs.fitted, is_free, &found);
    if (numbers_off(found) != is_free) return {};
  }
  if (!halves_agree(question, is_free, found)) return {};
  if (!pairs_gain(question, question.solve(question.pairs.fitted, {}, &found), found)) return {};
  return {CameraVerdict::kIsOff, found.change[kFocal], found.change[kBend]};
}

}  // namespace hermite
