#include "core/calibrate/camera_question.h"

#include <algorithm>
#include <cmath>

namespace hermite::calibrate {
namespace {

// An error must be this many standard deviations, and at most this many usual errors; beyond that
// it is not the camera's.
constexpr double kSignificant = 5, kMostUsual = 3;

// How many standard errors a gain of held-out pairs must be.
constexpr double kLeastMeanGainErrors = 3;

// The least mean gain by a focal length that is beyond what is usual. Errors of 8 % gain 26 to 58 %
// in surfaces and 18 to 40 % in corners. What redkitchen's sensor and fr1's shutter make of one, up
// to 4.4 %, gains at most 3 % in one of both and hardly ever in the other.
constexpr double kLeastForeignGain = 0.1;

}  // namespace

void Question::ask(const Asked& instead) {
  *std::ranges::find(asked, instead.number, &Asked::number) = instead;
}

JointSolution Question::solve(const std::vector<ViewPair>& of, const FreeNumbers& is_free,
                              const JointSolution* start) const {
  JointOptions options;
  options.is_free = is_free;
  for (const Asked& number : asked)
    options.prior_deviation[static_cast<Eigen::Index>(number.number)] = number.usual;
  return adjust_jointly(views, of, camera, options, start);
}

bool is_plausible(const Question& question, const JointSolution& solution) {
  return std::ranges::all_of(question.asked, [&solution](const Asked& asked) {
    return std::abs(solution.change[static_cast<Eigen::Index>(asked.number)]) <=
           kMostUsual * asked.usual;
  });
}

bool is_known(const Question& question, const JointSolution& solution) {
  return is_plausible(question, solution) &&
         std::ranges::all_of(question.asked, [&solution](const Asked& asked) {
           return solution.deviation[static_cast<Eigen::Index>(asked.number)] <= asked.known;
         });
}

FreeNumbers numbers_off(const Question& question, const JointSolution& solution) {
  FreeNumbers is_off{};
  for (const auto& [number, usual, known, off] : question.asked) {
    const auto k = static_cast<Eigen::Index>(number);
    is_off[number] =
        std::abs(solution.change[k]) >= std::max(off, kSignificant * solution.deviation[k]);
  }
  return is_off;
}

FreeNumbers timing_of(FreeNumbers numbers) {
  for (const CameraNumber number : kShape) numbers[number] = false;
  return numbers;
}

HeldOutGains gains_of_shape(const Question& question, const FreeNumbers& is_free,
                            const JointSolution& found) {
  const HeldOutPairs held_out{question.views, question.pairs.held_back, question.camera};
  const JointSolution without = question.solve(question.pairs.fitted, timing_of(is_free), &found);
  return {gain_of(held_out, without, found, ShowsIn::kSurfaces),
          gain_of(held_out, without, found, ShowsIn::kCorners)};
}

bool has_foreign_focal(const Question& question, const FreeNumbers& is_free,
                       const JointSolution& found) {
  if (std::abs(found.change[kFocal]) <= kMostUsual * usually_asked(kFocal).usual) return false;
  const HeldOutGains gains = gains_of_shape(question, is_free, found);
  return std::ranges::all_of(std::array{gains.in_surfaces, gains.in_corners}, [](const auto& gain) {
    return is_certain(gain) && gain.mean >= kLeastForeignGain;
  });
}

bool is_certain(const PairGain& gain) {
  return gain.pair_count >= kLeastPairsHeldBack &&
         gain.mean >= kLeastMeanGainErrors * gain.standard_error;
}

}  // namespace hermite::calibrate
