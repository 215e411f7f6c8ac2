#include "core/track/map_certainty.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "core/base/check.h"
#include "core/math/rigid3_fields.h"
#include "core/track/twist_covariance.h"

namespace hermite::track {

namespace {

// The columns of the views in a function of the state.
auto of_views(const Eigen::MatrixXd& of_state) {
  return of_state.rightCols(of_state.cols() - kCameraDoubtCount);
}

Eigen::Index state_of(std::size_t view) {
  return kCameraDoubtCount + 6 * static_cast<Eigen::Index>(view);
}

// A view is kept if the camera has moved or turned by this much since the last one (or half of
// both), as for calibration (core/calibrate/view_choice.cpp), or if the share of known surface is
// below this.
constexpr double kViewEvery_m = 0.15, kViewEvery_rad = 8 * M_PI / 180, kKnownGround = 0.6;
// The most views kept: a state of about 1000 elements. Beyond it, every second view of the older
// half is dropped.
constexpr std::size_t kMostViews = 160;

// Prior standard deviations of the camera's errors: depth of a Kinect is bent by 0 to 3.5 % (TUM's
// factors) and mostly calibrated to 1 %; focal lengths are within half a percent of the stated
// ones. Drivers deliver images without distortion, or state it; k1 of 0.003 displaces the corners
// of a Kinect's image by 0.2 %, as much as the error of the focal length does.
constexpr double kBend = 0.010, kFocal = 0.004, kRadial = 0.003;

// Number of pixels with a common error, for all pairs of a new view. With it the estimates are off
// by 1.2 standard deviations (RMS) over five runs in rendered scenes, undisturbed and with depth
// bent by 1.5 %.
constexpr double kAlikePixels = 6;

// Systematic error of what a view says, in addition to its noise: edges and corners of surfaces are
// displaced in a coarse image. Focal lengths are not learned at all: on a walk through doors
// (scene=loop, 620 frames) views gave 3.8 % too much, with a standard deviation of 0.6.
constexpr double kBendBias = 0.005;

// Standard deviation of an error of the camera that is reported as found.
constexpr double kToldDeviation = 0.001;

// The principal directions of an uncertainty are uncertain too: this share of its size is added in
// all directions.
constexpr double kAllWays = 0.15;

// Surfaces disagree by this factor where only noise is wrong, since it is correlated over
// pixels: 1.2 to 2 in rendered scenes with a Kinect's noise, up to 6 with a rolling shutter of 20
// ms, 4 to 20 in TUM's fr1. What errors of the camera do not explain of a covariance grows by what
// is beyond it (as by the ratio of Birge, 1932): what else is wrong is not known, but that
// something is.
constexpr double kUsualDisagreement = 2;

// Negligible beside any information, decisive where there is none.
constexpr double kNothing = 1e-6;

// Standard deviations of a loop measurement (links of core/adjust/submap_graph.cpp) and of a
// relocalisation.
constexpr double kLoop_m = 0.003, kLoop_rad = 0.002;

}  // namespace

Matrix6d found_again(const Rigid3& world_from_camera) {
  return isotropic(kLoop_m, kLoop_rad, world_from_camera.translation);
}

MapCertainty::MapCertainty()
    : mean_(Eigen::VectorXd::Zero(kCameraDoubtCount)),
      covariance_(Eigen::MatrixXd::Zero(kCameraDoubtCount, kCameraDoubtCount)) {
  covariance_(kBendDoubt, kBendDoubt) = kBend * kBend;
  covariance_(kFocalDoubt, kFocalDoubt) = kFocal * kFocal;
  covariance_(kRadialDoubt, kRadialDoubt) = kRadial * kRadial;
}

// Returns a frame's error as a linear function of the state, without noise. Directions that nothing
// constrains have the error of the last kept view.
Eigen::MatrixXd MapCertainty::share_of(const KnownSurface& known) const {
  Eigen::MatrixXd share = Eigen::MatrixXd::Zero(6, mean_.size());
  if (views_.empty()) return share;
  Matrix6d whole = known.whole;
  whole.diagonal().array() += kNothing * (1 + whole.trace());
  const Eigen::LDLT<Matrix6d> solver(whole);
  share.leftCols<kCameraDoubtCount>() = solver.solve(known.camera);
  Matrix6d rest = Matrix6d::Identity();
  for (std::size_t k = 0; k < views_.size(); ++k) {
    if (known.information[k].isZero()) continue;
    share.middleCols<6>(state_of(k)) = solver.solve(known.information[k]);
    rest -= share.middleCols<6>(state_of(k));
  }
  share.rightCols<6>() += rest;
  return share;
}

// Returns the part of a frame's covariance that errors of the camera explain.
Matrix6d MapCertainty::of_camera(const Eigen::MatrixXd& share) const {
  const Eigen::MatrixXd cross = share * covariance_.leftCols<kCameraDoubtCount>();
  return cross * covariance_.topLeftCorner<kCameraDoubtCount, kCameraDoubtCount>().ldlt().solve(
                     cross.transpose());
}

// Kalman update for observed = of_state * state + noise.
void MapCertainty::update(const Eigen::MatrixXd& of_state, const Eigen::VectorXd& observed,
                          const Eigen::MatrixXd& noise) {
  const Eigen::MatrixXd cross = covariance_ * of_state.transpose();
  const Eigen::MatrixXd innovation = of_state * cross + noise;
  const Eigen::MatrixXd gain = innovation.ldlt().solve(cross.transpose()).transpose();
  mean_ += gain * (observed - of_state * mean_);
  covariance_ -= gain * cross.transpose();
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
}

// Applies the loop closure that deformed the map so that surface which was not tracked against
// before agrees with the rest. Returns false if none of that surface constrains the frame.
bool MapCertainty::close_loop(const KnownSurface& known, const Matrix6d& step_covariance) {
  Matrix6d old = Matrix6d::Zero();
  const auto is_old = [this](std::size_t k) {
    return views_[k].submap < was_active_.size() && !was_active_[views_[k].submap];
  };
  for (std::size_t k = 0; k < views_.size(); ++k)
    if (is_old(k)) old += known.information[k];
  if (!(old.trace() > 0)) return false;
  old.diagonal().array() += kNothing * old.trace();
  const Eigen::LDLT<Matrix6d> solver(old);
  Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(6, mean_.size());
  for (std::size_t k = 0; k < views_.size(); ++k)
    if (is_old(k)) difference.middleCols<6>(state_of(k)) = -solver.solve(known.information[k]);
  difference.rightCols<6>() += Matrix6d::Identity();
  const Matrix6d noise =
      step_covariance + isotropic(kLoop_m, kLoop_rad, kept_world_from_camera_.translation);
  update(difference, Eigen::VectorXd::Zero(6), noise);
  path_noise_.close_loop(of_views(difference), noise);
  return true;
}

// Counts a frame for the doubt about the place.
void MapCertainty::doubt_place(const KnownSurface& known, const StepError& step,
                               const Ground& ground) {
  if (PlaceDoubt::is_cast_by(step.gap))
    place_doubt_.count_gap(step.gap, extent_m(std::span(views_).first(known_view_count_), ground));
  place_doubt_.observe(known.of_first_views, step.is_distinctive);
  if (place_doubt_.elsewhere_m() > 0)
    path_noise_.count_doubt(place_doubt_.second_moment().topLeftCorner<3, 3>().trace());
  else
    path_noise_.settle_doubt();
}

PoseUncertainty MapCertainty::observe(const frame::CoarseView& view,
                                      const frame::CoarseMask& moving,
                                      const Rigid3& world_from_camera, const StepError& step,
                                      const Ground& ground) {
  const Matrix6d& step_covariance = step.covariance;
  frame::CoarseView seen = thinned(view, moving);
  if (place_doubt_.elsewhere_m() == 0) known_view_count_ = views_.size();
  const KnownSurface known =
      known_surface({seen, world_from_camera}, views_, known_view_count_, ground);
  if (closure_count_ == ground.closure_count || views_.empty() ||
      close_loop(known, step_covariance)) {
    closure_count_ = ground.closure_count;
    was_active_ = ground.is_active;
  }
  const Eigen::MatrixXd share = share_of(known);
  const bool is_first = views_.empty();
  if (is_first) path_noise_.begin(step.timestamp_s);
  if (!is_first) doubt_place(known, step, ground);
  const Matrix6d noise =
      is_first ? Matrix6d::Zero()
               : path_noise_.count_step(step_covariance, world_from_camera.translation,
                                        step.timestamp_s);
  PoseUncertainty result;
  result.way_m = way_m_;
  if (!is_first) {
    const Eigen::VectorXd mean = share * mean_;
    const Matrix6d change = at_camera(world_from_camera.translation);
    const double beyond = std::max(1.0, step.disagreement / kUsualDisagreement) - 1;
    const Matrix6d covariance = share * covariance_ * share.transpose() + step_covariance;
    result.second_moment =
        change * (covariance + beyond * (covariance - of_camera(share)) + mean * mean.transpose()) *
        change.transpose();
    auto position = result.second_moment.topLeftCorner<3, 3>(),
         rotation = result.second_moment.bottomRightCorner<3, 3>();
    position.diagonal().array() += kAllWays * kAllWays * position.trace();
    rotation.diagonal().array() += kAllWays * kAllWays * rotation.trace();
    result.second_moment += place_doubt_.second_moment();
    result.elsewhere_m = place_doubt_.elsewhere_m();
  }
  const Rigid3 since_kept =
      is_first ? Rigid3{} : inverse(kept_world_from_camera_) * world_from_camera;
  const double distance_m = since_kept.translation.norm(),
               turn_rad = angle_rad(since_kept.rotation);
  if (!is_first && distance_m / kViewEvery_m + turn_rad / kViewEvery_rad < 1 &&
      known.known_share >= kKnownGround) {
    path_noise_.count_between();
    return result;
  }
  learn_camera(seen, world_from_camera, ground);
  const double surface_share =
      static_cast<double>(known.surface_count) / static_cast<double>(seen.size());
  const Matrix6d bias = surface_bias(surface_share, since_kept, world_from_camera.translation);
  path_noise_.keep(of_views(share), noise);
  keep(std::move(seen), world_from_camera, ground, share, step_covariance + bias);
  return result;
}

// Learns from a view that is about to be kept, compared with those before it.
void MapCertainty::learn_camera(const frame::CoarseView& seen, const Rigid3& world_from_camera,
                                const Ground& ground) {
  CameraTerms all;
  for (const KeptView& view : views_) {
    if (!view.is_tracked_against(ground)) continue;
    const SharedGround pair(seen, world_from_camera, view.seen, view.world_from_camera(ground));
    if (!pair.may_meet()) continue;
    const CameraTerms terms = camera_terms(pair);
    all.slope += terms.slope;
    all.information += terms.information;
    all.gradient += terms.gradient;
  }
  const double slope = all.slope(kBendDoubt, kBendDoubt),
               information = all.information(kBendDoubt, kBendDoubt);
  if (!(information > 0)) return;
  Eigen::MatrixXd of_state = Eigen::MatrixXd::Zero(1, mean_.size());
  of_state(0, kBendDoubt) = slope;
  const double by_focal = kFocal * all.slope(kBendDoubt, kFocalDoubt),
               by_radial = kRadial * all.slope(kBendDoubt, kRadialDoubt),
               by_itself = kBendBias * slope;
  const double variance = kAlikePixels * information + by_focal * by_focal + by_radial * by_radial +
                          by_itself * by_itself;
  update(of_state, all.gradient.head<1>(), Eigen::MatrixXd::Constant(1, 1, variance));
  learned_.push_back(all);
  if (learned_.size() > kMostViews) learned_.erase(learned_.begin());
}

// If the camera has errors that are not modelled, the views scatter more than expected; the
// deviation grows accordingly.
CalibrationDoubt MapCertainty::calibration() const {
  double squares = 0;
  for (const CameraTerms& terms : learned_) {
    const double left =
        terms.gradient[kBendDoubt] - terms.slope(kBendDoubt, kBendDoubt) * mean_[kBendDoubt];
    squares += left * left / terms.information(kBendDoubt, kBendDoubt);
  }
  const double alike = learned_.empty() ? 0 : squares / static_cast<double>(learned_.size());
  const double scatter = std::sqrt(std::max(1.0, alike / kAlikePixels));
  return {mean_[kBendDoubt],
          scatter * std::sqrt(std::max(0.0, covariance_(kBendDoubt, kBendDoubt))), camera_errors_};
}

void MapCertainty::begin_with(const CameraDoubts& deviations) {
  CHECK(views_.empty(), "begin_with() was called after a frame was observed");
  auto variances = covariance_.diagonal().head<kCameraDoubtCount>();
  withheld_ = (deviations.array() > 0)
                  .select((variances - deviations.cwiseAbs2()).cwiseMax(0), CameraDoubts::Zero());
  variances -= withheld_;
}

void MapCertainty::forget_calibration() {
  if (withheld_.isZero()) return;
  const CameraDoubtMatrix camera =
      covariance_.topLeftCorner<kCameraDoubtCount, kCameraDoubtCount>();
  const Eigen::MatrixXd of_camera =
      camera.ldlt().solve(covariance_.topRows<kCameraDoubtCount>()).transpose();
  covariance_ += of_camera * withheld_.asDiagonal() * of_camera.transpose();
  withheld_.setZero();
}

void MapCertainty::camera_is_off(double bend, const CertainErrors& errors) {
  observe_camera({bend, errors.focal, errors.k1}, CameraDoubts::Constant(kToldDeviation));
  camera_errors_ = errors;
}

ExpectedError MapCertainty::expected_error(const Ground& ground) const {
  const Eigen::Array<bool, kCameraDoubtCount, 1> known =
      mean_.head<kCameraDoubtCount>().array().square() >
      kKnownSigmas * kKnownSigmas * covariance_.diagonal().head<kCameraDoubtCount>().array();
  return path_noise_.expected(
      positions_of(views_, ground),
      known.any() ? mean_.tail(mean_.size() - kCameraDoubtCount).eval() : Eigen::VectorXd());
}

void MapCertainty::observe_camera(const CameraDoubts& errors, const CameraDoubts& deviations) {
  const CameraDoubts apart = errors - mean_.head<kCameraDoubtCount>(),
                     variances =
                         covariance_.diagonal().head<kCameraDoubtCount>() + deviations.cwiseAbs2();
  if ((apart.cwiseAbs().array() > kKnownSigmas * variances.cwiseSqrt().array()).any())
    forget_calibration();
  Eigen::MatrixXd of_state = Eigen::MatrixXd::Zero(kCameraDoubtCount, mean_.size());
  of_state.leftCols<kCameraDoubtCount>().setIdentity();
  update(of_state, errors, deviations.cwiseAbs2().asDiagonal().toDenseMatrix());
}

void MapCertainty::keep(frame::CoarseView seen, const Rigid3& world_from_camera,
                        const Ground& ground, const Eigen::MatrixXd& share, const Matrix6d& noise) {
  const Eigen::Index size = mean_.size();
  const Eigen::MatrixXd cross = share * covariance_;
  Eigen::VectorXd mean(size + 6);
  mean << mean_, share * mean_;
  Eigen::MatrixXd covariance(size + 6, size + 6);
  covariance << covariance_, cross.transpose(), cross, cross * share.transpose() + noise;
  mean_ = std::move(mean);
  covariance_ = std::move(covariance);
  views_.push_back({std::move(seen), ground.current,
                    inverse(ground.world_from_submap[ground.current]) * world_from_camera});
  if (views_.size() > 1)
    way_m_ += (world_from_camera.translation - kept_world_from_camera_.translation).norm();
  kept_world_from_camera_ = world_from_camera;
  if (views_.size() > kMostViews) drop_some();
}

// Drops every second view of the older half. What they have taught about the camera is kept, and
// their surface counts as that of other views.
void MapCertainty::drop_some() {
  std::vector<KeptView> kept;
  std::vector<Eigen::Index> rows(kCameraDoubtCount);
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  std::vector<std::size_t> numbers;
  std::size_t known_view_count = 0;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    if (k % 2 == 1 && 2 * k < views_.size()) continue;
    known_view_count += k < known_view_count_ ? 1 : 0;
    kept.push_back(std::move(views_[k]));
    numbers.push_back(k);
    for (Eigen::Index i = 0; i < 6; ++i) rows.push_back(state_of(k) + i);
  }
  views_ = std::move(kept);
  known_view_count_ = known_view_count;
  mean_ = mean_(rows).eval();
  covariance_ = covariance_(rows, rows).eval();
  path_noise_.keep_only(numbers);
}

void MapCertainty::begin_component(const Ground& ground) {
  path_noise_.begin_component(positions_of(views_, ground));
  way_m_ = 0;
  place_doubt_ = {};
  known_view_count_ = 0;
  views_.clear();
  mean_ = mean_.head<kCameraDoubtCount>().eval();
  covariance_ = covariance_.topLeftCorner<kCameraDoubtCount, kCameraDoubtCount>().eval();
}

void MapCertainty::save(ByteWriter& bytes) const {
  bytes.list(views_, [](ByteWriter& to, const KeptView& view) {
    frame::save(to, view.seen);
    to.number(view.submap);
    rigid3_fields(to, view.submap_from_camera);
  });
  bytes.numbers(mean_.data(), static_cast<std::size_t>(mean_.size()));
  bytes.numbers(covariance_.data(), static_cast<std::size_t>(covariance_.size()));
  rigid3_fields(bytes, kept_world_from_camera_);
  bytes.number(way_m_);
  bytes.flags(was_active_);
  bytes.number(closure_count_);
  certain_errors_fields(bytes, camera_errors_);
  bytes.list(learned_, camera_terms_fields<ByteWriter, const CameraTerms>);
  path_noise_.save(bytes);
  place_doubt_.save(bytes);
  bytes.number(known_view_count_);
  bytes.numbers(withheld_.data(), std::size_t{kCameraDoubtCount});
}

void MapCertainty::restore(ByteReader& bytes) {
  bytes.list(views_, [](ByteReader& from, KeptView& view) {
    frame::restore(from, view.seen);
    from.number(view.submap);
    rigid3_fields(from, view.submap_from_camera);
  });
  bytes.require(views_.size() <= kMostViews, "the views that certainty is told by");
  if (!bytes.ok()) return;
  const Eigen::Index size = state_of(views_.size());
  mean_.resize(size);
  covariance_.resize(size, size);
  bytes.numbers(mean_.data(), static_cast<std::size_t>(mean_.size()));
  bytes.numbers(covariance_.data(), static_cast<std::size_t>(covariance_.size()));
  rigid3_fields(bytes, kept_world_from_camera_);
  bytes.number(way_m_);
  bytes.flags(was_active_);
  bytes.number(closure_count_);
  certain_errors_fields(bytes, camera_errors_);
  bytes.list(learned_, camera_terms_fields<ByteReader, CameraTerms>);
  path_noise_.restore(bytes, views_.size());
  place_doubt_.restore(bytes);
  bytes.number(known_view_count_);
  bytes.numbers(withheld_.data(), std::size_t{kCameraDoubtCount});
  bytes.require(known_view_count_ <= views_.size(), "the views before the gap");
  bytes.require(
      mean_.allFinite() && covariance_.allFinite() && (withheld_.array() >= 0).all() &&
          std::isfinite(camera_errors_.focal + camera_errors_.k1 + camera_errors_.timing_s),
      "numbers of the certainty");
}

}  // namespace hermite::track
