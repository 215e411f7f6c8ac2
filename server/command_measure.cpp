// hermite measure
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/dataset/text_file.h"
#include "core/measure/measure.h"
#include "server/commands.h"
#include "server/result_files.h"

namespace hermite {

namespace {

struct MeasureArguments {
  std::string result, from, to;
  bool json = false;
};

Eigen::Vector3d point_of(const std::string& text, const char* option) {
  const std::vector<std::string_view> fields = split_fields(text);
  Eigen::Vector3d point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<double> number = fields.size() == 3 ? parse_finite(fields[axis]) : std::nullopt;
    if (!number) throw SetupError({ErrorCode::kInvalidArgument, std::string(option) + " " + text + ": not three numbers, x,y,z in metres"});
    point[static_cast<Eigen::Index>(axis)] = *number;
  }
  return point;
}

int run_measure(const MeasureArguments& arguments) {
  const Eigen::Vector3d from = point_of(arguments.from, "--from"), to = point_of(arguments.to, "--to");
  const ResultFiles files = or_throw(read_result_files(arguments.result));
  const MeasuredResult result{files.surfels, or_throw(map_knowledge_of(files.trajectory_text, files.report_json))};
  const Measurement measurement = or_throw(measure_distance(result, from, to));
  std::cout << (arguments.json ? format_measurement_json(measurement) : words_of(measurement.distance)) << '\n';
  return 0;
}

}  // namespace

Command add_measure_command(CLI::App& app) {
  auto arguments = std::make_shared<MeasureArguments>();
  CLI::App& measure = *app.add_subcommand("measure", "Measure the distance of two places of a result, with the interval of 95 %");
  measure.add_option("RESULT", arguments->result, "Folder as hermite reconstruct writes it")->required();
  measure.add_option("--from", arguments->from, "A point on or near a surface: x,y,z in the world of the scan [m]")->required();
  measure.add_option("--to", arguments->to, "Another one")->required();
  measure.add_flag("--json", arguments->json, "The places on the surface and what the interval is made of, too");
  return {&measure, [arguments] { return run_measure(*arguments); }};
}

}  // namespace hermite
