// hermite evaluate
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "core/evaluate/trajectory_error.h"
#include "server/commands.h"

namespace hermite {

namespace {

struct EvaluateArguments {
  std::string estimate, groundtruth;
};

Trajectory read_or_throw(const std::string& path) {
  Result<Trajectory> trajectory = read_tum_trajectory(path);
  if (!trajectory.ok()) throw SetupError(trajectory.error());
  return *std::move(trajectory);
}

int run_evaluate(const EvaluateArguments& arguments) {
  const Result<TrajectoryError> error = trajectory_error(read_or_throw(arguments.estimate), read_or_throw(arguments.groundtruth));
  if (!error.ok()) throw SetupError({ErrorCode::kNotFound, error.error().message});
  const std::string json = format_trajectory_error_json(*error);
  std::cout << json << (json.empty() || json.back() != '\n' ? "\n" : "");
  return 0;
}

}  // namespace

Command add_evaluate_command(CLI::App& app) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App& evaluate = *app.add_subcommand("evaluate", "Absolute and relative error of a trajectory, as JSON");
  evaluate.add_option("--estimate", arguments->estimate, "Trajectory to judge, TUM format")->required();
  evaluate.add_option("--groundtruth", arguments->groundtruth, "The true one, TUM format")->required();
  return {&evaluate, [arguments] { return run_evaluate(*arguments); }};
}

}  // namespace hermite
