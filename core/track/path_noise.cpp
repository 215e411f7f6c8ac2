#include "core/track/path_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/math/coasted_motion.h"
#include "core/track/twist_covariance.h"

namespace hermite::track {

namespace {

// A frame is well constrained if its step is known to this along every axis.
constexpr double kConstrained_m = 0.02, kConstrained_rad = 0.02;

// How fast a hand moves and turns the camera: 0.4 m and 0.6 rad per second, the mean speeds of
// TUM's handheld recordings (freiburg1: 0.2 to 0.4 m and 16 to 50 degrees per second). Only the
// norms matter.
const Vector6d kHandTwist_per_s = (Vector6d() << 0.4, 0, 0, 0.6, 0, 0).finished();

// Errors of consecutive frames are alike, since their noise stays with the camera and the surface;
// and a drift is partly undone by what is seen again. Measured.
constexpr double kOfSteps = 2.7, kOfDrift = 0.5;

double largest(const Eigen::Matrix3d& covariance) { return covariance.diagonal().maxCoeff(); }

}  // namespace

void PathNoise::begin(double timestamp_s) { constrained_s_ = timestamp_s; }

Matrix6d PathNoise::count_step(const Matrix6d& covariance, const Eigen::Vector3d& position_world,
                               double timestamp_s) {
  const Matrix6d to_camera = at_camera(position_world), to_world = at_camera(-position_world);
  Matrix6d error = to_camera * covariance * to_camera.transpose();
  const bool is_constrained =
      largest(error.topLeftCorner<3, 3>()) < kConstrained_m * kConstrained_m &&
      largest(error.bottomRightCorner<3, 3>()) < kConstrained_rad * kConstrained_rad;
  if (is_constrained) {
    constrained_s_ = timestamp_s;
  } else if (timestamp_s > constrained_s_) {
    const CoastedMotion coasted = coasted_motion(kHandTwist_per_s, timestamp_s - constrained_s_);
    Vector6d hand;
    hand << Eigen::Vector3d::Constant(coasted.position_sigma_m),
        Eigen::Vector3d::Constant(coasted.rotation_sigma_rad);
    // The sum of both kinds of knowledge: (error^-1 + hand^-1)^-1, which needs no inverse of
    // `error`.
    const Matrix6d of_hand = hand.cwiseAbs2().asDiagonal();
    error -= error * Matrix6d(error + of_hand).ldlt().solve(error);
    error = (0.5 * (error + error.transpose())).eval();
  }
  step_variance_sum_m2_ += error.topLeftCorner<3, 3>().trace();
  ++step_count_;
  ++frame_count_;
  return to_world * error * to_world.transpose();
}

void PathNoise::count_stall(double position_sigma_m) {
  stall_variance_sum_m2_ += 3 * position_sigma_m * position_sigma_m;
  ++frame_count_;
}

void PathNoise::keep(const Eigen::MatrixXd& share, const Matrix6d& noise) {
  CHECK(share.rows() == 6 && share.cols() == covariance_.cols(), "a share of each view");
  const Eigen::Index size = covariance_.cols();
  const Eigen::MatrixXd cross = share * covariance_;
  Eigen::MatrixXd covariance(size + 6, size + 6);
  covariance << covariance_, cross.transpose(), cross, cross * share.transpose() + noise;
  covariance_ = std::move(covariance);
  frames_.push_back(1);
}

void PathNoise::close_loop(const Eigen::MatrixXd& difference, const Matrix6d& noise) {
  const Eigen::MatrixXd cross = covariance_ * difference.transpose();
  covariance_ -=
      cross * Eigen::MatrixXd(difference * cross + noise).ldlt().solve(cross.transpose());
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
}

void PathNoise::keep_only(const std::vector<std::size_t>& views) {
  std::vector<double> frames(views.size());
  std::vector<Eigen::Index> rows;
  std::size_t next = 0;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    if (next < views.size() && views[next] == k) {
      for (Eigen::Index i = 0; i < 6; ++i) rows.push_back(6 * static_cast<Eigen::Index>(k) + i);
      ++next;
    }
    CHECK(next > 0, "the first view is kept");
    frames[next - 1] += frames_[k];
  }
  frames_ = std::move(frames);
  covariance_ = covariance_(rows, rows).eval();
}

void PathNoise::begin_component(const std::vector<Eigen::Vector3d>& positions_world) {
  double frames = 0;
  for (const double count : frames_) frames += count;
  drift_variance_sum_m2_ += frames * mean_square_m2(positions_world, covariance_);
  drift_frame_count_ += frames;
  frames_.clear();
  covariance_.resize(0, 0);
}

// Returns the expected mean square of the views' position errors, weighted by their frames, without
// the common rigid motion that fits them best: with H the sum of the squared derivatives H_k of the
// positions by that motion, and S the second moment of the views' errors, sum_k trace(H_k S_kk) -
// trace(H^-1 sum_kl H_k S_kl H_l).
double PathNoise::mean_square_m2(const std::vector<Eigen::Vector3d>& positions_world,
                                 const Eigen::MatrixXd& second_moment) const {
  CHECK(positions_world.size() == frames_.size(), "a position of each view");
  if (frames_.size() < 2) return 0;
  Matrix6d all = Matrix6d::Zero();
  Eigen::MatrixXd pulls(6, second_moment.cols());
  double frames = 0, squares = 0;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    const Eigen::Index at = 6 * static_cast<Eigen::Index>(k);
    const Eigen::Matrix<double, 3, 6> moved = at_camera(positions_world[k]).topRows<3>();
    const Matrix6d pull = frames_[k] * moved.transpose() * moved;
    pulls.middleCols<6>(at) = pull;
    all += pull;
    frames += frames_[k];
    squares += (pull * second_moment.block<6, 6>(at, at)).trace();
  }
  // Of a straight path one rotation changes nothing.
  all.diagonal().array() += 1e-9 * (1 + all.trace());
  squares -= all.ldlt().solve(pulls * second_moment * pulls.transpose()).trace();
  return std::max(0.0, squares) / frames;
}

ExpectedError PathNoise::expected(const std::vector<Eigen::Vector3d>& positions_world,
                                  const Eigen::VectorXd& known_errors) const {
  double frames = drift_frame_count_;
  for (const double count : frames_) frames += count;
  const double drift_sum =
      drift_variance_sum_m2_ +
      (frames - drift_frame_count_) * mean_square_m2(positions_world, covariance_);
  ExpectedError error;
  if (step_count_ > 0) error.step_m = std::sqrt(step_variance_sum_m2_ / step_count_);
  if (frames > 0) error.drift_m = std::sqrt(drift_sum / frames);
  if (frame_count_ > 0) {
    error.stall_m = std::sqrt(stall_variance_sum_m2_ / frame_count_);
    error.doubt_m = std::sqrt(doubt_variance_sum_m2_ / frame_count_);
  }
  if (known_errors.size() > 0)
    error.camera_m =
        std::sqrt(mean_square_m2(positions_world, known_errors * known_errors.transpose()));
  error.path_m = std::hypot(std::hypot(kOfSteps * error.step_m, kOfDrift * error.drift_m),
                            std::hypot(error.stall_m, error.doubt_m, error.camera_m));
  return error;
}

void PathNoise::save(ByteWriter& bytes) const {
  bytes.list(frames_, [](ByteWriter& to, double frames) { to.number(frames); });
  bytes.numbers(covariance_.data(), static_cast<std::size_t>(covariance_.size()));
  for (const double sum :
       {constrained_s_, frame_count_, step_count_, step_variance_sum_m2_, stall_variance_sum_m2_,
        doubt_variance_sum_m2_, drift_variance_sum_m2_, drift_frame_count_})
    bytes.number(sum);
}

void PathNoise::restore(ByteReader& bytes, std::size_t view_count) {
  bytes.list(frames_, [](ByteReader& from, double& frames) { from.number(frames); });
  bytes.require(frames_.size() == view_count, "the views of the path's noise");
  if (!bytes.ok()) return;
  const auto size = 6 * static_cast<Eigen::Index>(frames_.size());
  covariance_.resize(size, size);
  bytes.numbers(covariance_.data(), static_cast<std::size_t>(covariance_.size()));
  double sum = covariance_.sum();
  for (double* number : {&constrained_s_, &frame_count_, &step_count_, &step_variance_sum_m2_,
                         &stall_variance_sum_m2_, &doubt_variance_sum_m2_, &drift_variance_sum_m2_,
                         &drift_frame_count_}) {
    bytes.number(*number);
    sum += *number;
  }
  bytes.require(
      std::isfinite(sum) &&
          std::ranges::all_of(frames_,
                              [](double frames) { return frames >= 1 && frames < 1e15; }) &&
          std::min({frame_count_, step_count_, step_variance_sum_m2_, stall_variance_sum_m2_,
                    doubt_variance_sum_m2_, drift_variance_sum_m2_, drift_frame_count_}) >= 0,
      "numbers of the path's noise");
}

}  // namespace hermite::track
