#include "core/adjust/bundle_stage.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/bundle_residuals.h"

namespace hermite::adjust {

namespace {

using PoseBlock = std::array<double, 7>;  // quaternion x y z w, translation [m]

PoseBlock block_of(const Rigid3& pose) {
  PoseBlock block;
  Eigen::Map<Eigen::Vector4d>(block.data()) = pose.rotation.coeffs();
  Eigen::Map<Eigen::Vector3d>(block.data() + 4) = pose.translation;
  return block;
}
Rigid3 pose_of(const double* block) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(block)),
          Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

// Poses are perturbed by a twist on the right. The cost functions write derivatives by the twist
// into the first six of a pose's seven columns, so the Jacobian that Ceres multiplies with is the
// identity, and the chain rule through a quaternion is not needed.
class TwistManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const PoseBlock moved = block_of(pose_of(x) * exp_se3(Eigen::Map<const Vector6d>(delta)));
    std::copy(moved.begin(), moved.end(), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> twist(y_minus_x);
    twist = log_se3(inverse(pose_of(x)) * pose_of(y));
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

using PointJacobian = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
template <int kRows>
using PoseJacobian = Eigen::Map<Eigen::Matrix<double, kRows, 7, Eigen::RowMajor>>;

class ObservationCost final : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  ObservationCost(const BundleObservation& observation, const KeyframeView& view)
      : observation_(observation), view_(view) {}

  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    ObservationDerivatives derivatives;
    Eigen::Map<Eigen::Vector3d> whitened(residuals);
    whitened =
        observation_residual(observation_, view_, pose_of(blocks[0]), Eigen::Vector3d(blocks[1]),
                             jacobians == nullptr ? nullptr : &derivatives)
            .whitened;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr)
      PoseJacobian<3>(jacobians[0]) << derivatives.by_submap, Eigen::Vector3d::Zero();
    if (jacobians[1] != nullptr) PointJacobian{jacobians[1]} = derivatives.by_landmark;
    return true;
  }

 private:
  const BundleObservation& observation_;
  const KeyframeView& view_;
};

class LinkCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit LinkCost(const BundleLink& link)
      : from_from_to_(link.from_from_to), root_(square_root_of(link.information)) {}

  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    LinkDerivatives derivatives;
    Eigen::Map<Vector6d> whitened(residuals);
    whitened = root_ * link_residual(from_from_to_, pose_of(blocks[0]), pose_of(blocks[1]),
                                     jacobians == nullptr ? nullptr : &derivatives);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr)
      PoseJacobian<6>(jacobians[0]) << root_ * derivatives.by_from, Vector6d::Zero();
    if (jacobians[1] != nullptr)
      PoseJacobian<6>(jacobians[1]) << root_ * derivatives.by_to, Vector6d::Zero();
    return true;
  }

 private:
  Rigid3 from_from_to_;
  Matrix6d root_;
};

// The losses for the observations of one keyframe.
struct KeyframeLosses {
  KeyframeLosses(double weight, bool robust)
      : with_depth(robust ? new ceres::CauchyLoss(std::sqrt(kPixelAndDepthChi2)) : nullptr, weight,
                   ceres::TAKE_OWNERSHIP),
        without_depth(robust ? new ceres::CauchyLoss(std::sqrt(kPixelChi2)) : nullptr, weight,
                      ceres::TAKE_OWNERSHIP) {}

  ceres::ScaledLoss with_depth, without_depth;
};

class StopWhenAsked final : public ceres::IterationCallback {
 public:
  explicit StopWhenAsked(std::stop_token stop) : stop_(std::move(stop)) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop_.stop_requested() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  std::stop_token stop_;
};

// Owns everything that a Ceres problem points to. Blocks lie in arrays, because Ceres orders some
// of its work by address and must always find the same order. For the same reason the object does
// not move.
class StageProblem {
 public:
  StageProblem(const BundleProblem& problem, const BundleStage& stage, const BundleState& state)
      : landmarks_(state.landmarks_in_world) {
    poses_.reserve(state.world_from_submap.size());
    for (const Rigid3& pose : state.world_from_submap) poses_.push_back(block_of(pose));
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;  // validated in bundle_check.h
    ceres_ = std::make_unique<ceres::Problem>(options);
    add_observations(problem, stage);
    add_links(problem);
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!ceres_->HasParameterBlock(poses_[i].data())) continue;
      if (stage.submap_is_held[i])
        ceres_->SetParameterBlockConstant(poses_[i].data());
      else
        ceres_->SetManifold(poses_[i].data(), &manifold_);
    }
  }
  StageProblem(const StageProblem&) = delete;
  StageProblem& operator=(const StageProblem&) = delete;

  bool has_landmarks() const { return !observation_costs_.empty(); }
  ceres::Problem& ceres() { return *ceres_; }

  // Landmarks are eliminated first (Schur complement).
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering() {
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (Eigen::Vector3d& landmark : landmarks_)
      if (ceres_->HasParameterBlock(landmark.data()))
        ordering->AddElementToGroup(landmark.data(), 0);
    for (PoseBlock& pose : poses_)
      if (ceres_->HasParameterBlock(pose.data())) ordering->AddElementToGroup(pose.data(), 1);
    return ordering;
  }

  void write_to(BundleState& state) const {
    for (std::size_t i = 0; i < poses_.size(); ++i)
      if (ceres_->HasParameterBlock(poses_[i].data()) &&
          !ceres_->IsParameterBlockConstant(poses_[i].data()))
        state.world_from_submap[i] = pose_of(poses_[i].data());
    state.landmarks_in_world = landmarks_;
  }

 private:
  void add_observations(const BundleProblem& problem, const BundleStage& stage) {
    views_ = views_of(problem);
    for (const BundleKeyframe& keyframe : problem.keyframes)
      losses_.emplace_back(keyframe.weight, stage.robust);
    for (std::size_t i = 0; i < problem.observations.size(); ++i) {
      if (!stage.observation_is_used[i]) continue;
      const BundleObservation& observation = problem.observations[i];
      observation_costs_.emplace_back(observation, views_[observation.keyframe]);
      KeyframeLosses& losses = losses_[observation.keyframe];
      ceres_->AddResidualBlock(&observation_costs_.back(),
                               observation.depth_m > 0 ? &losses.with_depth : &losses.without_depth,
                               poses_[problem.keyframes[observation.keyframe].submap].data(),
                               landmarks_[observation.landmark].data());
    }
  }

  void add_links(const BundleProblem& problem) {
    for (const BundleLink& link : problem.links) {
      link_costs_.emplace_back(link);
      ceres_->AddResidualBlock(&link_costs_.back(), link.robust ? &cauchy_of_link_ : nullptr,
                               poses_[link.from].data(), poses_[link.to].data());
    }
  }

  std::vector<PoseBlock> poses_;
  std::vector<Eigen::Vector3d> landmarks_;
  std::vector<KeyframeView> views_;
  // Deques grow without moving their elements.
  std::deque<ObservationCost> observation_costs_;
  std::deque<KeyframeLosses> losses_;
  std::deque<LinkCost> link_costs_;
  TwistManifold manifold_;
  ceres::CauchyLoss cauchy_of_link_{std::sqrt(kPoseChi2)};
  std::unique_ptr<ceres::Problem> ceres_;  // last, so that it is destroyed before what it points to
};

}  // namespace

StageOutcome solve_stage(const BundleProblem& problem, const BundleStage& stage,
                         std::stop_token stop, BundleState& state) {
  StageProblem stage_problem(problem, stage, state);
  ceres::Solver::Options options;
  options.num_threads = 1;  // sums are made in a fixed order
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = stage.iterations;
  options.function_tolerance = stage.least_progress;
  if (stage_problem.has_landmarks()) {
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.linear_solver_ordering = stage_problem.ordering();
  } else {
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  }
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  StopWhenAsked callback(std::move(stop));
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &stage_problem.ceres(), &summary);
  if (summary.IsSolutionUsable()) stage_problem.write_to(state);
  // Includes the evaluation at the start; zero when nothing is free.
  const int evaluation_count = static_cast<int>(summary.iterations.size());
  return {std::max(0, evaluation_count - 1), summary.termination_type == ceres::CONVERGENCE,
          summary.termination_type == ceres::USER_SUCCESS};
}

double cauchy_cost(double chi2, double bound) { return 0.5 * bound * std::log1p(chi2 / bound); }

}  // namespace hermite::adjust
