#include "core/calibrate/shape_explanation.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace hermite::calibrate {
namespace {

// A dozen views confuse focal length, distortion and bend: with a Kinect's noise all three together
// are up to 0.8 %, 0.009 and 0.5 % off, while those that are off are found within a sixth when only
// they are free. So the fewest of them are taken that explain what all three do: that lose no more
// than what these gain from noise, up to 0.3 % of the squares of surfaces and 0.2 % of those of
// corners. Too few of them lose 1 to 12 % of one of both.
constexpr double kMostLoss = 0.005;

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

}  // namespace

std::optional<Explanation> lens_of(const Question& question, const Explanation& without) {
  Explanation with_all = without;
  with_all.is_free[kRadial] = true;
  with_all.solution = question.solve(question.pairs.fitted, with_all.is_free, &without.solution);
  if (!numbers_off(question, with_all.solution)[kRadial]) return std::nullopt;
  Explanation found = simplest(question, with_all);
  if (!found.is_free[kRadial] || !numbers_off(question, found.solution)[kRadial])
    return std::nullopt;
  return found;
}

}  // namespace hermite::calibrate
