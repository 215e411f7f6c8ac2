#include "core/calibrate/camera_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/calibrate/pair_agreement.h"
#include "core/calibrate/view_choice.h"

namespace hermite::calibrate {
namespace {

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
constexpr double kUsualRadial = 0.05;
constexpr double kNeedNotBeKnown = std::numeric_limits<double>::infinity();
constexpr std::array<Asked, 6> kAsked{{{kFocal, 0.010, 0.0015, 0.004},
                                       {kRadial, kUsualRadial, kNeedNotBeKnown, 0.006},
                                       {kBend, 0.015, 0.0005, 0.003},
                                       {kDepthReadout, 0.015, kNeedNotBeKnown, 0.005},
                                       {kColorReadout, 0.015, kNeedNotBeKnown, 0.005},
                                       {kColorDelay, 0.012, kNeedNotBeKnown, 0.003}}};

// An error must be this many standard deviations, and at most this many usual errors; beyond that
// it is not the camera's.
constexpr double kSignificant = 5, kMostUsual = 3;

// A half of the views may differ from the whole by half of the value, or by what is not significant
// in that half.
constexpr double kMostApart = 0.5, kMostApartDeviations = 3;

// For the held-out pairs, the least mean relative decrease of squared distances, and how many
// standard errors it must be. An undisturbed camera gives -0.2 to 0.1 %.
constexpr double kLeastMeanGain = 0.005, kLeastMeanGainErrors = 3;

// The deviations of an adjustment are too small where its pairs are few or err alike: with depth in
// a tenth of the image, bend was 0.5 % off with a deviation of 0.16. And each answer counts the
// views of the one before it again.
constexpr double kWider = 3;

// A dozen views confuse focal length, distortion and bend: with a Kinect's noise all three together
// are up to 0.8 %, 0.009 and 0.5 % off, while those that are off are found within a sixth when only
// they are free. So the fewest of them are taken that explain what all three do: that lose no more
// than what these gain from noise, up to 0.3 % of the squares of surfaces and 0.2 % of those of
// corners. Too few of them lose 1 to 12 % of one of both.
constexpr double kMostLoss = 0.005;

// A camera fits if what is measured of its shape, with its deviation, excludes errors this many
// times as great as those that count as off. Among desks a focal length of -1.26 % came out as
// 0.38 +- 0.37 % from 12 views, and as 0.87 and 1.16 % from 16 and 24. Of cameras that fit, three
// in four rendered scenes are at most 1.3 times as far off with 16 views.
constexpr double kMostLeft = 1.5;

constexpr std::size_t kLeastPairs = 24, kLeastPairsOfHalf = 12, kLeastPairsHeldBack = 6;

constexpr double off_of(CameraNumber number) {
  return std::ranges::find(kAsked, number, &Asked::number)->off;
}

constexpr std::array kShape{kFocal, kRadial, kBend};
constexpr std::array kTiming{kDepthReadout, kColorReadout, kColorDelay};

bool has_shape(const FreeNumbers& numbers) {
  return std::ranges::any_of(kShape, [&](CameraNumber number) { return numbers[number]; });
}

FreeNumbers timing_of(FreeNumbers numbers) {
  for (const CameraNumber number : kShape) numbers[number] = false;
  return numbers;
}

struct Question {
  const std::vector<CalibrationView>& views;
  const Camera& camera;
  const ChosenPairs pairs;

  JointSolution solve(const std::vector<ViewPair>& of, const FreeNumbers& is_free,
                      const JointSolution* start) const {
    JointOptions options;
    options.is_free = is_free;
    for (const Asked& asked : kAsked)
      options.prior_deviation[static_cast<Eigen::Index>(asked.number)] = asked.usual;
    return adjust_jointly(views, of, camera, options, start);
  }
};

bool is_plausible(const JointSolution& solution) {
  return std::ranges::all_of(kAsked, [&solution](const Asked& asked) {
    return std::abs(solution.change[static_cast<Eigen::Index>(asked.number)]) <=
           kMostUsual * asked.usual;
  });
}

bool is_known(const JointSolution& solution) {
  return is_plausible(solution) && std::ranges::all_of(kAsked, [&solution](const Asked& asked) {
           return solution.deviation[static_cast<Eigen::Index>(asked.number)] <= asked.known;
         });
}

FreeNumbers numbers_off(const JointSolution& solution) {
  FreeNumbers is_off{};
  for (const auto& [number, usual, known, off] : kAsked) {
    const auto k = static_cast<Eigen::Index>(number);
    is_off[number] =
        std::abs(solution.change[k]) >= std::max(off, kSignificant * solution.deviation[k]);
  }
  return is_off;
}

// Returns those of the free numbers that each half of the views confirms.
FreeNumbers same_in_halves(const Question& question, const FreeNumbers& is_free,
                           const JointSolution& all) {
  FreeNumbers is_same = is_free;
  for (const bool is_second : {false, true}) {
    const std::vector<ViewPair> half =
        pairs_of_half(question.pairs.fitted, question.views.size(), is_second);
    if (half.size() < kLeastPairsOfHalf) return {};
    const JointSolution solution = question.solve(half, is_free, &all);
    for (const Asked& asked : kAsked) {
      const auto k = static_cast<Eigen::Index>(asked.number);
      const double allowed = std::max(kMostApart * std::abs(all.change[k]),
                                      kMostApartDeviations * solution.deviation[k]);
      if (std::abs(solution.change[k] - all.change[k]) > allowed) is_same[asked.number] = false;
    }
  }
  return is_same;
}

// In the order of ShapeErrors.
Eigen::Array3d shape_of(const CameraVector& numbers) {
  return {numbers[kBend], numbers[kFocal], numbers[kRadial]};
}
ShapeErrors errors_of(const Eigen::Array3d& shape) { return {shape[0], shape[1], shape[2]}; }

// Returns what a solution says of the camera's shape without a verdict on it: as much as each half
// of the views confirms.
std::optional<MeasuredShape> measured(const Question& question, const FreeNumbers& is_free,
                                      const JointSolution& all) {
  if (!is_plausible(all)) return std::nullopt;
  Eigen::Array3d deviations = (kWider * shape_of(all.deviation))
                                  .max(Eigen::Array3d(kFitting.bend, kFitting.focal, kFitting.k1));
  for (const bool is_second : {false, true}) {
    const std::vector<ViewPair> half =
        pairs_of_half(question.pairs.fitted, question.views.size(), is_second);
    if (half.size() < kLeastPairsOfHalf) return std::nullopt;
    const CameraVector apart = question.solve(half, is_free, &all).change - all.change;
    deviations = deviations.max(shape_of(apart).abs());
  }
  deviations[2] = kUsualRadial;  // it was held fixed
  return MeasuredShape{errors_of(-shape_of(all.change)), errors_of(deviations)};
}

bool excludes_errors(const MeasuredShape& shape) {
  const auto& [errors, deviations] = shape;
  return std::abs(errors.focal) + deviations.focal <= kMostLeft * off_of(kFocal) &&
         std::abs(errors.bend) + deviations.bend <= kMostLeft * off_of(kBend);
}

bool is_certain(const PairGain& gain) {
  return gain.pair_count >= kLeastPairsHeldBack &&
         gain.mean >= kLeastMeanGainErrors * gain.standard_error;
}

// Whether the held-out pairs agree better with the shape of the camera.
bool shape_gains(const Question& question, const HeldOutPairs& held_out, const FreeNumbers& is_free,
                 const JointSolution& found) {
  const JointSolution without = question.solve(question.pairs.fitted, timing_of(is_free), &found);
  const auto gains_in = [&](ShowsIn where) {
    const PairGain gain = gain_of(held_out, without, found, where);
    return is_certain(gain) && gain.mean >= kLeastMeanGain;
  };
  // Where walls are seen from the front, these two move corners but hardly a surface.
  const bool moves_corners = is_free[kFocal] || is_free[kRadial];
  return gains_in(ShowsIn::kSurfaces) || (moves_corners && gains_in(ShowsIn::kCorners));
}

// Whether they agree better with this number of its timing. It shows in fast movements only, so the
// mean over all pairs may gain little by it.
bool timing_gains(const Question& question, const HeldOutPairs& held_out, FreeNumbers is_free,
                  CameraNumber number, const JointSolution& found) {
  is_free[number] = false;
  const JointSolution without = question.solve(question.pairs.fitted, is_free, &found);
  return is_certain(gain_of(held_out, without, found, where_shows(number)));
}

// Returns those of the free numbers that each half of the views and the held-out pairs confirm: all
// of the camera's shape or nothing of it, since its numbers are confused with one another, and each
// of its timing. The others stay free meanwhile, so that they do not bend these.
FreeNumbers confirmed(const Question& question, const FreeNumbers& is_free,
                      const JointSolution& found) {
  const HeldOutPairs held_out{question.views, question.pairs.held_back, question.camera};
  FreeNumbers is_confirmed = same_in_halves(question, is_free, found);
  const bool is_shape =
      has_shape(is_free) &&
      std::ranges::all_of(
          kShape, [&](CameraNumber number) { return is_confirmed[number] == is_free[number]; }) &&
      shape_gains(question, held_out, is_free, found);
  for (const CameraNumber number : kShape) is_confirmed[number] = is_free[number] && is_shape;
  for (const CameraNumber number : kTiming)
    is_confirmed[number] =
        is_confirmed[number] && timing_gains(question, held_out, is_free, number, found);
  return is_confirmed;
}

bool changes_shape(const CameraCheck& check) {
  return std::ranges::any_of(kShape, [&check](CameraNumber number) {
    return check.change[static_cast<Eigen::Index>(number)] != 0;
  });
}

// The squares of all pairs, fitted and held out.
struct Squares {
  std::vector<double> in_surfaces, in_corners;
};

Squares squares_with(const Question& question, const JointSolution& solution) {
  std::vector<ViewPair> pairs = question.pairs.fitted;
  pairs.insert(pairs.end(), question.pairs.held_back.begin(), question.pairs.held_back.end());
  const Camera camera = changed(question.camera, solution.change);
  const std::vector<Rigid3>& poses = solution.world_from_camera;
  return {squares_of(agreements_of(question.views, poses, pairs, camera)),
          squares_of(corner_reprojections_of(question.views, poses, pairs, camera))};
}

struct Explanation {
  FreeNumbers is_free{};
  JointSolution solution;
};

// Returns the fewest of focal length, distortion and bend that explain what all three do, and of
// equally many those that lose least.
Explanation simplest(const Question& question, const Explanation& with_all) {
  using Shape = std::array<bool, 3>;  // focal length, distortion, bend
  constexpr std::array<Shape, 7> kShapes{{{},
                                          {true, false, false},
                                          {false, true, false},
                                          {false, false, true},
                                          {true, true, false},
                                          {true, false, true},
                                          {false, true, true}}};
  const Squares least = squares_with(question, with_all.solution);
  std::optional<Explanation> best;
  double least_loss = std::numeric_limits<double>::infinity();
  std::ptrdiff_t best_count = 0;
  for (const Shape& shape : kShapes) {
    const std::ptrdiff_t count = std::ranges::count(shape, true);
    if (best && count > best_count) break;
    Explanation trial = with_all;
    trial.is_free[kFocal] = shape[0];
    trial.is_free[kRadial] = shape[1];
    trial.is_free[kBend] = shape[2];
    trial.solution = question.solve(question.pairs.fitted, trial.is_free, &with_all.solution);
    const Squares squares = squares_with(question, trial.solution);
    const double in_surfaces = gain_of(squares.in_surfaces, least.in_surfaces).mean,
                 in_corners = gain_of(squares.in_corners, least.in_corners).mean;
    if (std::max(in_surfaces, in_corners) > kMostLoss || in_surfaces + in_corners >= least_loss)
      continue;
    least_loss = in_surfaces + in_corners;
    best_count = count;
    best = std::move(trial);
  }
  return best ? *std::move(best) : with_all;
}

// Returns what explains the views if a distortion of the lens is a part of it.
std::optional<Explanation> lens_of(const Question& question, const Explanation& without) {
  Explanation with_all = without;
  with_all.is_free[kRadial] = true;
  with_all.solution = question.solve(question.pairs.fitted, with_all.is_free, &without.solution);
  if (!numbers_off(with_all.solution)[kRadial]) return std::nullopt;
  Explanation found = simplest(question, with_all);
  if (!found.is_free[kRadial] || !numbers_off(found.solution)[kRadial]) return std::nullopt;
  return found;
}

// Judges a solution with these free parameters. `measured` is not set if a shape that is off was
// not confirmed, or if the shape was not asked for.
CameraCheck verdict_on(const Question& question, const FreeNumbers& is_free, JointSolution found) {
  constexpr MeasuredShape kFits{{}, kFitting};
  const FreeNumbers is_off = numbers_off(found);
  if (is_off == FreeNumbers{}) return {CameraVerdict::kFits, CameraVector::Zero(), kFits};
  if (is_off != is_free) {
    found = question.solve(question.pairs.fitted, is_off, &found);
    if (numbers_off(found) != is_off) return {};
  }
  if (!is_plausible(found)) return {};
  const FreeNumbers is_confirmed = confirmed(question, is_off, found);
  if (is_confirmed == FreeNumbers{}) return {};
  CameraCheck check{CameraVerdict::kIsOff};
  for (const Asked& asked : kAsked)
    if (is_confirmed[asked.number])
      check.change[static_cast<Eigen::Index>(asked.number)] =
          found.change[static_cast<Eigen::Index>(asked.number)];
  if (has_shape(is_free) && has_shape(is_off) == has_shape(is_confirmed)) check.measured = kFits;
  return check;
}

}  // namespace

CameraCheck check_camera(const std::vector<CalibrationView>& views, const Camera& camera,
                         Lenses lenses) {
  const Question question{views, camera, choose_pairs(views, camera)};
  if (question.pairs.fitted.size() < kLeastPairs ||
      question.pairs.held_back.size() < kLeastPairsHeldBack)
    return {};
  const bool has_velocities = std::ranges::all_of(
      views, [](const CalibrationView& view) { return view.known_twist_per_s.has_value(); });
  FreeNumbers all{}, depth_rows{};
  for (const Asked& asked : kAsked) all[asked.number] = has_velocities || !is_timing(asked.number);
  all[kRadial] = false;
  depth_rows[kDepthReadout] = true;
  const JointSolution found = question.solve(question.pairs.fitted, all, nullptr);
  std::optional<Explanation> lens;
  if (lenses == Lenses::kOne) lens = lens_of(question, {all, found});
  CameraCheck check;
  if (lens) {
    check = verdict_on(question, lens->is_free, lens->solution);
  } else if (is_known(found)) {
    check = verdict_on(question, all, found);
  }
  if (check.measured && changes_shape(check)) return check;
  const std::optional<MeasuredShape> shape = lens ? std::nullopt : measured(question, all, found);
  const bool does_shape_fit = check.measured && shape && excludes_errors(*shape);
  if (!does_shape_fit) check.measured = shape;
  if (check.verdict == CameraVerdict::kFits && !does_shape_fit) {
    check.verdict = CameraVerdict::kUnknown;
    return check;
  }
  if (check.verdict != CameraVerdict::kUnknown) return check;
  // Something else is wrong with the camera, or its movement does not tell its shape; the timing
  // may be clear nevertheless, or at least that of depth, which harms tracking most.
  for (const FreeNumbers& is_free : {timing_of(all), depth_rows}) {
    if (!has_velocities) break;
    const CameraCheck of_timing =
        verdict_on(question, is_free, question.solve(question.pairs.fitted, is_free, &found));
    if (of_timing.verdict == CameraVerdict::kIsOff)
      return {CameraVerdict::kIsOff, of_timing.change, check.measured};
  }
  return check;
}

}  // namespace hermite::calibrate
