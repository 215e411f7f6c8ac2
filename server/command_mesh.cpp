// hermite mesh
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "server/commands.h"
#include "server/mesh_file.h"

namespace hermite::commands {

namespace {

struct MeshArguments {
  std::string source, out;
  double cell_mm = 0;
  double least_part_cm2 = mesh::ContourOptions().least_part_m2 * 1e4;
  MeshMaking making;
};

std::string mesh_path(const MeshArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  if (!std::filesystem::is_directory(arguments.source))
    throw SetupError({ErrorCode::kInvalidArgument,
                      fmt::format("--out is missing: {} is no folder that mesh.ply would go to",
                                  arguments.source)});
  return arguments.source + "/mesh.ply";
}

int run_mesh(const MeshArguments& arguments) {
  const std::string out = mesh_path(arguments);
  MeshMaking making = arguments.making;
  making.contour.field.cell_m = arguments.cell_mm / 1000;
  making.contour.least_part_m2 = arguments.least_part_cm2 / 1e4;
  std::cout << make_mesh_file(mesh_source_path(arguments.source), making, out).dump(2) << '\n';
  return 0;
}

}  // namespace

Command add_mesh_command(CLI::App& app) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App& mesh = *app.add_subcommand(
      "mesh",
      "Make a surface of triangles out of a cloud: dual contouring of its implicit surface");
  mesh.add_option("RESULT", arguments->source,
                  "Folder as hermite reconstruct writes it, or any PLY of points with normals")
      ->required();
  mesh.add_option("--out", arguments->out,
                  "PLY file for the mesh (default: mesh.ply in that folder)");
  mesh.add_option("--cell", arguments->cell_mm,
                  "Edge of a cell [mm], 2 to 100; 0: the distance of the points, within 5 and 40")
      ->capture_default_str();
  mesh.add_option("--min-part", arguments->least_part_cm2,
                  "Leave out pieces that hang together with nothing and have less surface [cm^2]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  mesh.add_option("--support", arguments->making.contour.field.support_spacings,
                  "Radius of a point's support in distances of points")
      ->check(CLI::Range(1.5, 10.0))
      ->capture_default_str();
  CLI::Option* simplify =
      mesh.add_option("--simplify", arguments->making.simplify_mm,
                      "Take fewer triangles where the surface moves by less than this [mm]")
          ->check(CLI::Range(0.01, 1000.0));
  mesh.add_option("--triangles", arguments->making.triangles,
                  "With --simplify: not fewer than these")
      ->needs(simplify)
      ->check(CLI::Range(0, 1 << 30));
  mesh.add_option("--fill-holes", arguments->making.holes.width_m,
                  "Fill holes that are no wider than this [m] as the surface around them goes on; "
                  "what is filled is marked")
      ->check(CLI::Range(0.001, mesh::kMostHoleWidth_m));
  mesh.add_flag("--close", arguments->making.holes.closes_all,
                "Close all that is open, for printing, wherever the surface ends, too; what is "
                "closed is marked");
  mesh.add_flag("!--smooth-edges", arguments->making.contour.field.keep_edges,
                "Do not tell surfaces that meet in an edge from each other");
  return {&mesh, [arguments] { return run_mesh(*arguments); }};
}

}  // namespace hermite::commands
