#include "server/evaluate_trajectory.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/dataset/text_file.h"
#include "core/evaluate/trajectory_error.h"
#include "core/output/ply.h"
#include "core/source/open_sequence.h"

namespace hermite::commands {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

dataset::Trajectory read_groundtruth(const std::string& source) {
  if (dataset::is_file(source)) return or_throw(dataset::read_tum_trajectory(source));
  Result<std::unique_ptr<dataset::Sequence>> sequence = source::open_sequence(source);
  if (!sequence.ok())
    throw SetupError(in_context("ground truth, no file of that name", sequence.error()));
  dataset::Trajectory groundtruth = (*sequence)->groundtruth();
  if (groundtruth.empty()) throw SetupError({ErrorCode::kNotFound, source + " has no true poses"});
  return groundtruth;
}

Json evaluate_trajectory(const TrajectoryJudging& judging) {
  const dataset::Trajectory estimate = or_throw(dataset::read_tum_trajectory(judging.estimate));
  const Result<evaluate::TrajectoryError> error =
      evaluate::trajectory_error(estimate, read_groundtruth(judging.groundtruth));
  if (!error.ok()) throw SetupError({ErrorCode::kNotFound, error.error().message});
  if (!judging.per_frame.empty())
    or_throw(output::write_file_atomically(judging.per_frame,
                                           evaluate::format_frame_errors_csv(error->frames)));
  return Json::parse(evaluate::format_trajectory_error_json(*error));
}

Json evaluate_consistency(const TrajectoryJudging& judging) {
  const std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence(judging.consistency));
  std::vector<dataset::Trajectory> trajectories{
      or_throw(dataset::read_tum_trajectory(judging.estimate))};
  std::vector<std::string> names{"estimate"};
  dataset::Trajectory groundtruth =
      judging.groundtruth.empty() ? sequence->groundtruth() : read_groundtruth(judging.groundtruth);
  if (!groundtruth.empty()) {
    trajectories.push_back(std::move(groundtruth));
    names.push_back("groundtruth");
  }
  evaluate::ConsistencyOptions options;
  options.spacings = judging.spacings;
  return Json::parse(evaluate::format_consistency_json(
      or_throw(evaluate::depth_consistency(*sequence, trajectories, options)), names));
}

}  // namespace hermite::commands
