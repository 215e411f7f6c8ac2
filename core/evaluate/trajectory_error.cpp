#include "core/evaluate/trajectory_error.h"

#include <fmt/core.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace hermite::evaluate {
namespace {

constexpr std::size_t kMinMatchedPoses = 3;
constexpr double kPerSecond_s = 1.0;

struct MatchedPose {
  std::size_t estimate_index;
  dataset::TimedPose estimate, groundtruth;
};

std::vector<double> times_of(const dataset::Trajectory& trajectory) {
  std::vector<double> times_s;
  times_s.reserve(trajectory.size());
  for (const dataset::TimedPose& pose : trajectory) times_s.push_back(pose.timestamp_s);
  return times_s;
}

Result<std::vector<MatchedPose>> match_poses(const dataset::Trajectory& estimate,
                                             const dataset::Trajectory& groundtruth,
                                             double max_gap_s) {
  const auto pairs =
      dataset::associate_by_time(times_of(estimate), times_of(groundtruth), max_gap_s);
  if (!pairs.ok()) return pairs.error();
  if (pairs->size() < kMinMatchedPoses)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("only {} of {} estimated poses have one of the {} true poses at most "
                             "{:f} s away, needed are {}",
                             pairs->size(), estimate.size(), groundtruth.size(), max_gap_s,
                             kMinMatchedPoses)};
  std::vector<MatchedPose> matched;
  for (const dataset::IndexPair& pair : *pairs)
    matched.push_back({pair.first, estimate[pair.first], groundtruth[pair.second]});
  return matched;
}

double degrees(const Eigen::Quaterniond& rotation) { return angle_rad(rotation) * 180.0 / M_PI; }

FrameError::Step motion_error(const MatchedPose& from, const MatchedPose& to) {
  const Rigid3 true_motion =
      inverse(from.groundtruth.world_from_camera) * to.groundtruth.world_from_camera;
  const Rigid3 estimated_motion =
      inverse(from.estimate.world_from_camera) * to.estimate.world_from_camera;
  const Rigid3 difference = inverse(true_motion) * estimated_motion;
  return {difference.translation.norm(), degrees(difference.rotation)};
}

struct RelativeErrors {
  std::vector<double> translation_m, rotation_deg;

  void add(const FrameError::Step& step) {
    translation_m.push_back(step.translation_m);
    rotation_deg.push_back(step.rotation_deg);
  }
  RelativeError summary() const {
    return {static_cast<std::int64_t>(translation_m.size()), statistics_of(translation_m),
            statistics_of(rotation_deg)};
  }
};

std::vector<FrameError> frame_errors(const std::vector<MatchedPose>& matched,
                                     const Rigid3& groundtruth_from_estimate) {
  std::vector<FrameError> frames;
  for (std::size_t i = 0; i < matched.size(); ++i) {
    const Rigid3 aligned = groundtruth_from_estimate * matched[i].estimate.world_from_camera;
    const Rigid3& truth = matched[i].groundtruth.world_from_camera;
    FrameError frame{static_cast<std::int64_t>(matched[i].estimate_index),
                     matched[i].estimate.timestamp_s,
                     (truth.translation - aligned.translation).norm(),
                     degrees(truth.rotation.conjugate() * aligned.rotation), std::nullopt};
    if (i > 0 && matched[i].estimate_index == matched[i - 1].estimate_index + 1)
      frame.step = motion_error(matched[i - 1], matched[i]);
    frames.push_back(frame);
  }
  return frames;
}

RelativeErrors frame_to_frame(const std::vector<FrameError>& frames) {
  RelativeErrors errors;
  for (const FrameError& frame : frames)
    if (frame.step) errors.add(*frame.step);
  return errors;
}

// Pairs every pose with the one nearest to a second later. Times ascend, so `to` only moves
// forward.
RelativeErrors over_one_second(const std::vector<MatchedPose>& matched, double max_gap_s) {
  RelativeErrors errors;
  std::size_t to = 0;
  for (const MatchedPose& from : matched) {
    const double goal_s = from.estimate.timestamp_s + kPerSecond_s;
    const auto distance_s = [&](std::size_t i) {
      return std::abs(matched[i].estimate.timestamp_s - goal_s);
    };
    while (to + 1 < matched.size() && distance_s(to + 1) <= distance_s(to)) ++to;
    if (distance_s(to) <= max_gap_s) errors.add(motion_error(from, matched[to]));
  }
  return errors;
}

void put(nlohmann::ordered_json& json, const std::string& name, const std::string& unit,
         const ErrorStatistics& statistics) {
  json[fmt::format("{}_rmse_{}", name, unit)] = statistics.rmse;
  json[fmt::format("{}_mean_{}", name, unit)] = statistics.mean;
  json[fmt::format("{}_median_{}", name, unit)] = statistics.median;
  json[fmt::format("{}_max_{}", name, unit)] = statistics.max;
}

}  // namespace

ErrorStatistics statistics_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  double sum = 0, sum_of_squares = 0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  const std::size_t middle = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return {std::sqrt(sum_of_squares / count), sum / count, median, values.back()};
}

Rigid3 align_points(const std::vector<Eigen::Vector3d>& target,
                    const std::vector<Eigen::Vector3d>& source) {
  CHECK(!target.empty() && target.size() == source.size(), "align_points needs pairs");
  Eigen::Vector3d target_mean = Eigen::Vector3d::Zero(), source_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < target.size(); ++i) {
    target_mean += target[i];
    source_mean += source[i];
  }
  target_mean /= static_cast<double>(target.size());
  source_mean /= static_cast<double>(source.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < target.size(); ++i)
    covariance += (target[i] - target_mean) * (source[i] - source_mean).transpose();

  // Umeyama 1991, Eq. 40 and 43: the last singular direction is flipped if the optimal orthogonal
  // matrix is a reflection.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool mirrors = svd.matrixU().determinant() * svd.matrixV().determinant() < 0;
  const Eigen::Vector3d signs(1, 1, mirrors ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const Eigen::Quaterniond quaternion = Eigen::Quaterniond(rotation).normalized();
  return {quaternion, target_mean - quaternion * source_mean};
}

Result<TrajectoryError> trajectory_error(const dataset::Trajectory& estimate,
                                         const dataset::Trajectory& groundtruth, double max_gap_s) {
  if (const Status status = dataset::validate(estimate, "estimate"); !status.ok())
    return status.error();
  if (const Status status = dataset::validate(groundtruth, "ground truth"); !status.ok())
    return status.error();
  const auto matched = match_poses(estimate, groundtruth, max_gap_s);
  if (!matched.ok()) return matched.error();

  std::vector<Eigen::Vector3d> estimated, truth;
  for (const MatchedPose& pose : *matched) {
    estimated.push_back(pose.estimate.world_from_camera.translation);
    truth.push_back(pose.groundtruth.world_from_camera.translation);
  }
  TrajectoryError error;
  error.matched_count = static_cast<std::int64_t>(matched->size());
  error.estimate_count = static_cast<std::int64_t>(estimate.size());
  error.groundtruth_from_estimate = align_points(truth, estimated);
  error.frames = frame_errors(*matched, error.groundtruth_from_estimate);
  std::vector<double> distances_m;
  for (const FrameError& frame : error.frames) distances_m.push_back(frame.translation_m);
  error.ate_m = statistics_of(distances_m);
  error.per_frame = frame_to_frame(error.frames).summary();
  const RelativeError per_second = over_one_second(*matched, max_gap_s).summary();
  if (per_second.pair_count > 0) error.per_second = per_second;
  return error;
}

std::string format_trajectory_error_json(const TrajectoryError& error) {
  nlohmann::ordered_json json;
  json["matched_poses"] = error.matched_count;
  json["estimate_poses"] = error.estimate_count;
  put(json, "ate", "m", error.ate_m);
  put(json, "rpe_translation", "m", error.per_frame.translation_m);
  put(json, "rpe_rotation", "deg", error.per_frame.rotation_deg);
  if (error.per_second) {
    put(json, "rpe_1s_translation", "m", error.per_second->translation_m);
    put(json, "rpe_1s_rotation", "deg", error.per_second->rotation_deg);
  }
  const Eigen::Matrix4d matrix = error.groundtruth_from_estimate.matrix();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      json["groundtruth_from_estimate"].push_back(matrix(row, column));
  return json.dump(2) + "\n";
}

std::string format_frame_errors_csv(const std::vector<FrameError>& frames) {
  std::string text =
      "index,timestamp_s,translation_error_m,rotation_error_deg,step_translation_error_m,step_"
      "rotation_error_deg\n";
  // A double in %f needs at most 309 digits before the point.
  std::array<char, 4 * 330> line{};
  const auto append = [&](int length) {
    text.append(line.data(), static_cast<std::size_t>(length));
  };
  for (const FrameError& frame : frames) {
    append(std::snprintf(line.data(), line.size(), "%lld,%.6f,%.9f,%.6f,",
                         static_cast<long long>(frame.index), frame.timestamp_s,
                         frame.translation_m, frame.rotation_deg));
    if (frame.step)
      append(std::snprintf(line.data(), line.size(), "%.9f,%.6f", frame.step->translation_m,
                           frame.step->rotation_deg));
    text += frame.step ? "\n" : ",\n";
  }
  return text;
}

}  // namespace hermite::evaluate
