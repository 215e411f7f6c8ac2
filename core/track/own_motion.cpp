#include "core/track/own_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/track/surface_alignment.h"

namespace hermite::track {

namespace {

// Share of the visible area in square metres; above it, it is unknown which part is the room. A
// person in front of the camera may cover most of the view, but a room has more surface than a
// person.
constexpr double kMostMoving = 0.4;

// Of pairs of a surface whose motion is known.
constexpr int kLeastPairs = 20;

// Gauss-Newton steps from the tracked pose, and if the room may have moved differently.
constexpr int kSteps = 2, kStepsWhenMoving = 6;

// A surface is suspicious if its chi-square with 6 degrees of freedom (median 5.35) exceeds any
// noise, and exceeds this many times the usual value of surfaces of this scan. The first-order
// value is less than the final one, so the limit is lower than that for a motion. A surface moves
// if the chi-square of its own motion is this many times the median of the other surfaces: noise is
// correlated over pixels and lenses bend depth, which affects all of them alike. Its motion must
// also be this share of its displacement by the camera, since rolling shutters and late images
// shift what is seen by a part of that. Where nothing moves (250 frames of redkitchen, fr1, the
// rendered room with depth bent by 1.5 %; views 4 and 30 frames apart) one surface in a thousand
// has 375 and 0.39, in fr1 637 and 0.25; a person who walks ahead has 490 to 3500 and 0.45 to 0.9
// after the first step. A surface that moved rests again once it is below either lower limit.
constexpr double kMedianChi2 = 5.35, kSuspicious = 60;
constexpr double kMoves = 400, kStillMoves = 60;
constexpr double kShareOfCamera = 0.4, kStillShareOfCamera = 0.1;

// The most suspicious surfaces, each of which is left out in turn.
constexpr std::size_t kTried = 3;

// The motion of one surface relative to the others.
struct Apart {
  bool is_known = false;
  double chi2 = 0, share_of_camera = 0;
  bool is_beyond(double least_chi2, double least_share) const {
    return is_known && chi2 > least_chi2 && share_of_camera > least_share;
  }
};

// Returns, by surface, the first-order chi-square of its own motion against that of the others; 0:
// too few pairs.
std::vector<double> suspicions(const std::vector<SurfaceSystem>& systems,
                               const std::vector<bool>& moves) {
  std::vector<double> chi2(systems.size(), 0);
  const SurfaceSystem all = sum_of_resting(systems, moves);
  for (std::size_t surface = 1; surface < systems.size(); ++surface) {
    const SurfaceSystem& own = systems[surface];
    if (own.pairs < kLeastPairs || moves[surface]) continue;
    const auto own_factor =
        (own.hessian + kMotionPriorInformation * Matrix6d::Identity()).eval().ldlt();
    const auto rest_factor = (all.hessian - own.hessian).eval().ldlt();
    const Vector6d apart = own_factor.solve(own.right_hand_side) -
                           rest_factor.solve(all.right_hand_side - own.right_hand_side);
    const Matrix6d covariance =
        own_factor.solve(Matrix6d::Identity()) + rest_factor.solve(Matrix6d::Identity());
    chi2[surface] = apart.dot(covariance.ldlt().solve(apart));
  }
  return chi2;
}

// Returns by how much the chi-squares of resting surfaces exceed those of independent noise.
double disagreement(const std::vector<SurfaceSystem>& systems, const std::vector<bool>& moves) {
  std::vector<double> chi2 = suspicions(systems, moves);
  std::erase(chi2, 0);
  if (chi2.empty()) return 1;
  const auto middle = chi2.begin() + static_cast<std::ptrdiff_t>(chi2.size() / 2);
  std::nth_element(chi2.begin(), middle, chi2.end());
  return std::max(1.0, *middle / kMedianChi2);
}

// Returns areas by surface: the area that a pixel covers grows with the square of its distance.
std::vector<double> areas_of(const frame::CoarseView& frame, const ViewSurfaces& surfaces) {
  std::vector<double> areas(surfaces.pixel_count.size(), 0);
  for (std::size_t i = 0; i < frame.size(); ++i)
    areas[surfaces.of_pixel[i]] += double{frame.depth_m[i]} * double{frame.depth_m[i]};
  return areas;
}

// The search for moving surfaces, one after the other.
class Search {
 public:
  Search(const frame::CoarseView& frame, const ViewSurfaces& surfaces,
         const frame::CoarseView& earlier, const CameraMotion& motion,
         const SurfaceExperience& experience)
      : comparison_(frame, surfaces, earlier),
        first_scales_(scales_at_first(frame, earlier)),
        motion_(motion),
        usual_disagreement_(experience.usual_disagreement),
        area_(areas_of(frame, surfaces)) {
    State first{experience.moved_before, {}};
    if (is_most(first.moves)) first.moves.assign(first.moves.size(), false);
    first.rest = comparison_.align(motion.earlier_from_frame, first_scales_, first.moves, kSteps);
    state_ = std::move(first);
  }

  // Returns whether a further moving surface was found.
  bool find_one();

  // Call once no further surface is found.
  OwnMotions result() const;

 private:
  struct State {
    std::vector<bool> moves;        // by surface
    SurfaceAlignment::Result rest;  // alignment of the others
  };
  bool is_most(const std::vector<bool>& moves) const;
  std::vector<std::size_t> suspects() const;
  State without(std::size_t surface) const;
  Apart apart(const State& state, std::size_t surface) const;

  const SurfaceAlignment comparison_;
  const ResidualScales first_scales_;
  const CameraMotion& motion_;
  const double usual_disagreement_;
  const std::vector<double> area_;
  State state_;
  bool is_divided_ = false;           // see OwnMotions
  Vector6d pull_ = Vector6d::Zero();  // see OwnMotions
};

bool Search::is_most(const std::vector<bool>& moves) const {
  double moving = 0;
  for (std::size_t surface = 1; surface < moves.size(); ++surface)
    moving += moves[surface] ? area_[surface] : 0;
  return moving > kMostMoving * std::accumulate(area_.begin(), area_.end(), 0.0);
}

// Returns the most suspicious surfaces, in this order.
std::vector<std::size_t> Search::suspects() const {
  const std::vector<double> chi2 = suspicions(state_.rest.systems, state_.moves);
  std::vector<std::size_t> suspects;
  for (std::size_t surface = 1; surface < chi2.size(); ++surface)
    if (chi2[surface] > kSuspicious * usual_disagreement_) suspects.push_back(surface);
  std::sort(suspects.begin(), suspects.end(),
            [&chi2](std::size_t a, std::size_t b) { return chi2[a] > chi2[b]; });
  if (suspects.size() > kTried) suspects.resize(kTried);
  return suspects;
}

// Returns the state in which this surface moves, too.
Search::State Search::without(std::size_t surface) const {
  State result{state_.moves, {}};
  result.moves[surface] = true;
  result.rest = comparison_.align(state_.rest.earlier_from_frame, first_scales_, result.moves,
                                  kStepsWhenMoving);
  return result;
}

// Returns the motion of a surface relative to those that rest in `state`.
Apart Search::apart(const State& state, std::size_t surface) const {
  std::vector<bool> others(comparison_.surface_count(), true);
  others[surface] = false;
  const Rigid3& rest_pose = state.rest.earlier_from_frame;
  const SurfaceSystem rest = sum_of_resting(state.rest.systems, state.moves);
  const SurfaceAlignment::Result alone =
      comparison_.align(rest_pose, state.rest.scales, others, kStepsWhenMoving);
  const SurfaceSystem& own = alone.systems[surface];
  if (own.pairs < kLeastPairs) return {};
  const Matrix6d prior = kMotionPriorInformation * Matrix6d::Identity();
  const Vector6d twist = log_se3(alone.earlier_from_frame * inverse(rest_pose));
  const Matrix6d covariance = (own.hessian + prior).inverse() + rest.hessian.inverse();
  // Returns how far a twist moves the points, as far as the residuals show it.
  const auto length = [&own](const Vector6d& x) { return std::sqrt(x.dot(own.hessian * x)); };
  const double by_camera = length(log_se3(rest_pose)) + length(motion_.step_before_earlier) +
                           length(motion_.step_before_frame);
  const double chi2 = twist.dot(covariance.ldlt().solve(twist)),
               usual = std::max(usual_disagreement_, disagreement(state.rest.systems, state.moves));
  return {true, chi2 / usual, length(twist) / std::max(by_camera, 1e-9)};
}

bool Search::find_one() {
  is_divided_ = false;
  pull_.setZero();
  State best;
  double most = 0, most_certain = kMoves;
  for (const std::size_t suspect : suspects()) {
    State trial = without(suspect);
    const Apart alone = apart(trial, suspect);
    if (alone.is_beyond(most_certain, 0)) {
      most_certain = alone.chi2;
      pull_ = log_se3(trial.rest.earlier_from_frame * inverse(state_.rest.earlier_from_frame));
    }
    if (!alone.is_beyond(kMoves, kShareOfCamera)) continue;
    is_divided_ = is_divided_ || is_most(trial.moves);
    if (is_most(trial.moves) || alone.chi2 <= most) continue;
    most = alone.chi2;
    best = std::move(trial);
  }
  if (!(most > 0)) return false;
  state_ = std::move(best);
  return true;
}

OwnMotions Search::result() const {
  const std::vector<SurfaceSystem>& systems = state_.rest.systems;
  OwnMotions result{std::vector<OwnMotion>(state_.moves.size(), OwnMotion::kUnknown),
                    disagreement(systems, state_.moves), is_divided_, pull_};
  for (std::size_t surface = 1; surface < state_.moves.size(); ++surface) {
    const Apart alone = state_.moves[surface] ? apart(state_, surface)
                                              : Apart{systems[surface].pairs >= kLeastPairs};
    if (!alone.is_known) continue;
    result.of_surface[surface] =
        alone.is_beyond(kStillMoves, kStillShareOfCamera) ? OwnMotion::kMoves : OwnMotion::kRests;
  }
  return result;
}

}  // namespace

OwnMotions own_motions(const frame::CoarseView& frame, const ViewSurfaces& surfaces,
                       const frame::CoarseView& earlier, const CameraMotion& motion,
                       const SurfaceExperience& experience) {
  Search search(frame, surfaces, earlier, motion, experience);
  while (search.find_one()) {
  }
  return search.result();
}

}  // namespace hermite::track
