// What is asked of the views of a camera_check.h: the tested parameters, when one counts as off,
// and the adjustments that answer it. Pure functions, any thread.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/calibrate/joint_adjustment.h"
#include "core/calibrate/pair_agreement.h"
#include "core/calibrate/view_choice.h"

namespace hermite::calibrate {

// A tested parameter: its usual error, the standard deviation needed for a verdict, and the error
// from which on it counts as off. Usual errors are those of calibrate.cpp. In rendered scenes with
// Kinect noise, 12 to 40 views give deviations of 0.02 to 0.07 % of focal length and 0.01 to 0.03 %
// of bend, and values up to 0.21 and 0.09 % if nothing is off. If something else is wrong, as with
// redkitchen's sensor or fr1's shutter, the deviations are 0.25 to 1.6 % and 0.04 to 0.6 %.
//
// The timing need not be known: it does no harm to a camera that moves too slowly for it to show.
struct Asked {
  CameraNumber number;
  double usual, known, off;
};
inline constexpr double kUsualRadial = 0.05;
inline constexpr double kNeedNotBeKnown = std::numeric_limits<double>::infinity();
inline constexpr std::array<Asked, 6> kAsked{{{kFocal, 0.010, 0.0015, 0.004},
                                              {kRadial, kUsualRadial, kNeedNotBeKnown, 0.006},
                                              {kBend, 0.015, 0.0005, 0.003},
                                              {kDepthReadout, 0.015, kNeedNotBeKnown, 0.005},
                                              {kColorReadout, 0.015, kNeedNotBeKnown, 0.005},
                                              {kColorDelay, 0.012, kNeedNotBeKnown, 0.003}}};

// In place of its row, for the focal length of another camera or of another size of the image. With
// 12 % as the usual error, up to 36 % are plausible.
inline constexpr Asked kForeignFocal{kFocal, 0.12, 0.005, 0.004};

constexpr const Asked& usually_asked(CameraNumber number) {
  return *std::ranges::find(kAsked, number, &Asked::number);
}

inline constexpr std::array kShape{kFocal, kRadial, kBend};
inline constexpr std::array kTiming{kDepthReadout, kColorReadout, kColorDelay};

struct Question {
  const std::vector<CalibrationView>& views;
  const Camera& camera;
  const ChosenPairs pairs;
  std::array<Asked, 6> asked = kAsked;

  // Takes this in place of what is asked of the same parameter.
  void ask(const Asked& instead);

  // Adjusts poses and the free parameters to these pairs, with the usual errors as priors. `start`
  // as for adjust_jointly.
  JointSolution solve(const std::vector<ViewPair>& of, const FreeNumbers& is_free,
                      const JointSolution* start) const;
};

// Returns whether no parameter is beyond what is believed of it: some of its usual errors.
bool is_plausible(const Question& question, const JointSolution& solution);

// Returns whether the solution is plausible and all parameters are known well enough for a verdict.
bool is_known(const Question& question, const JointSolution& solution);

// Returns the parameters that are off by more than noise and by more than matters.
FreeNumbers numbers_off(const Question& question, const JointSolution& solution);

// Returns those of the free numbers that are of the timing.
FreeNumbers timing_of(FreeNumbers numbers);

// By how much held-out pairs agree better.
struct HeldOutGains {
  PairGain in_surfaces, in_corners;
};

// What the shape of the camera gains in `found`, whose free numbers these are.
HeldOutGains gains_of_shape(const Question& question, const FreeNumbers& is_free,
                            const JointSolution& found);

// Returns whether the focal length of `found` is beyond what is usual, but agrees so much better
// with the held-out pairs that it is believed, as that of another camera.
bool has_foreign_focal(const Question& question, const FreeNumbers& is_free,
                       const JointSolution& found);

// The least number of held-out pairs that decides anything.
inline constexpr std::size_t kLeastPairsHeldBack = 6;

// Returns whether so many held-out pairs gain more than by chance.
bool is_certain(const PairGain& gain);

}  // namespace hermite::calibrate
