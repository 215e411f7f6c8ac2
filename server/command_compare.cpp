// hermite compare
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "core/base/printf_text.h"
#include "core/compare/compare_output.h"
#include "core/dataset/text_file.h"
#include "core/measure/measure.h"
#include "core/output/ply.h"
#include "server/commands.h"
#include "server/mesh_file.h"
#include "server/ply_file.h"

namespace hermite::commands {

namespace {

struct CompareArguments {
  std::string first, second, out;
  double least_change_mm = 1000 * compare::ChangeOptions().least_change_m;
  double least_area_cm2 = 1e4 * compare::ChangeOptions().least_area_m2;
  double least_deviations = compare::ChangeOptions().least_deviations;
  bool json = false;
};

std::int64_t part_count_of(const std::string& folder, const std::string& trajectory_text) {
  const std::string path = folder + "/report.json";
  if (!std::filesystem::exists(path)) return 1;
  return or_throw(
             measure::map_knowledge_of(trajectory_text, or_throw(dataset::read_text_file(path))))
      .part_count;
}

// Says what is uncertain about a result whose map is in parts.
void warn_of_parts(const std::string& folder, std::int64_t part_count) {
  if (part_count > 1)
    std::cerr << "hermite: " << folder << " is in " << part_count
              << " parts, since the camera was lost between them; how they lie to each other is "
                 "unknown, and counts as a change\n";
}

compare::ComparedScan read_scan(const std::string& path) {
  const std::string points = mesh_source_path(path);
  const output::PlyShape shape = read_ply_file(points);
  if (shape.normals.empty())
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         points +
             " has no points with normals (nx, ny, nz): the sides of its surface cannot be told"});
  dataset::Trajectory trajectory;
  std::int64_t part_count = 1;
  if (const std::string file = path + "/trajectory.txt"; std::filesystem::exists(file)) {
    const std::string text = or_throw(dataset::read_text_file(file));
    trajectory = or_throw(dataset::parse_tum_trajectory(text));
    part_count = part_count_of(path, text);
  }
  compare::ComparedScan scan =
      or_throw(compare::ComparedScan::create(output::cloud_of(shape), std::move(trajectory), path));
  scan.set_part_count(part_count);
  return scan;
}

void print_regions(const compare::Comparison& comparison) {
  std::cout << printf_text(
      "%zu changes; %.1f m^2 were compared, and %.1f m^2 of the first scan were not seen by the "
      "second\n",
      comparison.regions.size(), comparison.compared_area_m2, comparison.unseen_area_m2);
  for (const compare::ChangedRegion& region : comparison.regions) {
    const Eigen::Vector3d middle_m = (region.low_m + region.high_m) / 2;
    std::string line = printf_text("%-13s %8.4f m^2 at (%.2f, %.2f, %.2f)", name_of(region.kind),
                                   region.area_m2, middle_m.x(), middle_m.y(), middle_m.z());
    if (region.kind == compare::RegionKind::kMovedAway ||
        region.kind == compare::RegionKind::kMovedTowards)
      line += printf_text(" by %.1f mm ± %.1f mm (95 %%)", 1000 * std::abs(region.mean_distance_m),
                          1000 * measure::kDeviationsOfConfidence * region.sigma_m);
    std::cout << line << '\n';
  }
  if (!comparison.sees_b)
    std::cout
        << "Nothing could be called removed: the path of the second scan's camera is unknown\n";
  if (!comparison.sees_a)
    std::cout << "Nothing could be called added: the path of the first scan's camera is unknown\n";
}

int run_compare(const CompareArguments& arguments) {
  const compare::ChangeOptions options{arguments.least_change_mm / 1000, arguments.least_deviations,
                                       arguments.least_area_cm2 / 1e4};
  or_throw(validate(options));
  const compare::ComparedScan first = read_scan(arguments.first),
                              second = read_scan(arguments.second);
  warn_of_parts(arguments.first, first.part_count());
  warn_of_parts(arguments.second, second.part_count());
  std::error_code failure;
  std::filesystem::create_directories(arguments.out, failure);
  if (failure)
    throw SetupError(
        {ErrorCode::kIo, fmt::format("cannot create {}: {}", arguments.out, failure.message())});
  const compare::Comparison comparison = or_throw(compare::compare_scans(first, second, options));
  const std::string report = compare::format_comparison_json(comparison, options);
  const bool is_same_place =
      comparison.registration.verdict == compare::RegistrationVerdict::kSamePlace;
  const std::string ply = arguments.out + "/changes.ply";
  if (is_same_place)
    or_throw(output::write_file_atomically(ply, compare::format_changes_ply(comparison)));
  else
    // It is of an earlier comparison, and would not belong to this report.
    std::filesystem::remove(ply, failure);
  or_throw(output::write_file_atomically(arguments.out + "/report.json", report));
  if (arguments.json)
    std::cout << report;
  else
    std::cout << comparison.registration.message << '\n';
  if (!is_same_place) return kFailed;
  if (!arguments.json) print_regions(comparison);
  return 0;
}

}  // namespace

Command add_compare_command(CLI::App& app) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App& compare =
      *app.add_subcommand("compare", "Find what has changed between two scans of a place");
  compare
      .add_option("FIRST", arguments->first,
                  "Folder as hermite reconstruct writes it, or any PLY of points with normals")
      ->required();
  compare.add_option("SECOND", arguments->second, "The later scan, of the same kinds")->required();
  compare
      .add_option("--out", arguments->out,
                  "Folder for report.json and changes.ply, which is made if it is missing")
      ->required();
  compare
      .add_option("--least-change", arguments->least_change_mm,
                  "Smallest distance that is reported as a change [mm], 1 to 90")
      ->capture_default_str();
  compare
      .add_option("--deviations", arguments->least_deviations,
                  "A change must be this many standard deviations large, too; 1 to 20")
      ->capture_default_str();
  compare
      .add_option("--least-area", arguments->least_area_cm2,
                  "Changed regions with less surface are dropped [cm^2], up to 100000")
      ->capture_default_str();
  compare.add_flag("--json", arguments->json, "Print report.json");
  return {&compare, [arguments] { return run_compare(*arguments); }};
}

}  // namespace hermite::commands
