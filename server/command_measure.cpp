// hermite measure
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/dataset/text_file.h"
#include "core/measure/measure.h"
#include "server/commands.h"
#include "server/result_files.h"

namespace hermite::commands {

namespace {

struct MeasureArguments {
  std::string result, kind, up;
  std::vector<std::string> points;
  bool json = false;
};

Eigen::Vector3d triple_of(const std::string& text, const std::string& option) {
  const std::vector<std::string_view> fields = dataset::split_fields(text);
  Eigen::Vector3d triple;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::optional<double> number =
        fields.size() == 3 ? dataset::parse_finite(fields[axis]) : std::nullopt;
    if (!number)
      throw SetupError({ErrorCode::kInvalidArgument,
                        fmt::format("{} {}: not three numbers, x,y,z", option, text)});
    triple[static_cast<Eigen::Index>(axis)] = *number;
  }
  return triple;
}

measure::MeasureRequest request_of(const MeasureArguments& arguments) {
  const std::optional<measure::MeasureKind> kind = measure::measure_kind_of(arguments.kind);
  if (!kind)
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         fmt::format("--kind {}: it is one of {}", arguments.kind, measure::measure_kind_names())});
  measure::MeasureRequest request{*kind, {}, std::nullopt};
  for (const std::string& point : arguments.points)
    request.points.push_back(triple_of(point, "--point"));
  if (!arguments.up.empty()) request.up = triple_of(arguments.up, "--up");
  or_throw(measure::check_measure_request(request));
  return request;
}

int run_measure(const MeasureArguments& arguments) {
  const measure::MeasureRequest request = request_of(arguments);
  const ResultFiles files = or_throw(read_result_files(arguments.result));
  const measure::EachPoint each_point =
      [&](const std::function<void(const output::CloudPoint&)>& use) {
        return output::for_each_ply_point(files.surfels, use);
      };
  const measure::MeasuredResult result{
      each_point, or_throw(measure::map_knowledge_of(files.trajectory_text, files.report_json))};
  const measure::Measurement measurement = or_throw(measure::measure(result, request));
  std::cout << (arguments.json ? measure::format_measurement_json(measurement)
                               : measure::text_of(measurement.quantity))
            << '\n';
  return 0;
}

}  // namespace

Command add_measure_command(CLI::App& app) {
  auto arguments = std::make_shared<MeasureArguments>();
  CLI::App& measure = *app.add_subcommand(
      "measure", "Measure between places of a result, with the interval of 95 %");
  measure.add_option("RESULT", arguments->result, "Folder as hermite reconstruct writes it")
      ->required();
  measure
      .add_option("--kind", arguments->kind,
                  "distance of two points; plane: of a point from the plane at another one; height "
                  "of two points along --up; angle that the "
                  "surfaces at two points enclose; area of the polygon of 3 to 64 points")
      ->default_val(std::string(measure::row_of(measure::MeasureKind::kDistance).name));
  measure
      .add_option(
          "--point", arguments->points,
          "On or near a surface: x,y,z in the world of the scan [m]; once for each, in order")
      ->required();
  measure.add_option(
      "--up", arguments->up,
      "Of a height: which way is up, x,y,z of a unit vector; 0,-1,0 is the first camera's");
  measure.add_flag("--json", arguments->json,
                   "The places on the surface and what the interval is made of, too");
  return {&measure, [arguments] { return run_measure(*arguments); }};
}

}  // namespace hermite::commands
