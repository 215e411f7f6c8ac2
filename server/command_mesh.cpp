// hermite mesh
#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/mesh/contour.h"
#include "core/mesh/hole_fill.h"
#include "core/mesh/simplify.h"
#include "core/output/mesh_ply.h"
#include "core/output/ply.h"
#include "server/commands.h"
#include "server/ply_file.h"

namespace hermite {

namespace {

using Json = nlohmann::ordered_json;

struct MeshArguments {
  std::string source, out;
  double cell_mm = 0;
  double least_part_cm2 = ContourOptions().least_part_m2 * 1e4;
  double simplify_mm = 0;  // 0: not at all
  std::int64_t triangles = 0;
  HoleFillOptions holes;
  ContourOptions options;
};

// Of a result folder what meshes are made of, or at least its cloud; or a file.
std::string cloud_path(const std::string& source) {
  if (!std::filesystem::is_directory(source)) return source;
  return source + (std::filesystem::exists(source + "/surfels.ply") ? "/surfels.ply" : "/cloud.ply");
}

std::string mesh_path(const MeshArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  if (!std::filesystem::is_directory(arguments.source))
    throw SetupError({ErrorCode::kInvalidArgument, "--out is missing: " + arguments.source + " is no folder that mesh.ply would go to"});
  return arguments.source + "/mesh.ply";
}

Cloud read_cloud(const std::string& path) {
  const PlyShape shape = read_ply_file(path);
  if (shape.normals.empty())
    throw SetupError(
        {ErrorCode::kInvalidArgument, path + " has no points with normals (nx, ny, nz): the sides of its surface cannot be told"});
  return cloud_of(shape);
}

int run_mesh(const MeshArguments& arguments) {
  using Clock = std::chrono::steady_clock;
  const std::string out = mesh_path(arguments);
  Cloud cloud = read_cloud(cloud_path(arguments.source));
  const std::size_t point_count = cloud.size();
  ContourOptions options = arguments.options;
  options.field.cell_m = arguments.cell_mm / 1000;
  options.least_part_m2 = arguments.least_part_cm2 / 1e4;
  ContourStatistics statistics;
  const Clock::time_point start = Clock::now();
  TriangleMesh mesh = or_throw(contour(std::move(cloud), options, {}, &statistics));
  if (arguments.simplify_mm > 0) mesh = or_throw(simplified(mesh, {arguments.simplify_mm / 1000, arguments.triangles}));
  HoleFillStatistics holes;
  if (arguments.holes.width_m > 0 || arguments.holes.closes_all) mesh = or_throw(holes_filled(mesh, arguments.holes, {}, &holes));
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  or_throw(write_file_atomically(out, format_mesh_ply(mesh)));
  std::cout << Json{{"mesh", out},
                    {"points", point_count},
                    {"points_left_out", statistics.rejected_points},
                    {"cell_m", statistics.cell_m},
                    {"vertices", mesh.positions_m.size()},
                    {"triangles", mesh.triangles.size()},
                    {"parts_left_out", statistics.removed_parts},
                    {"split_vertices", statistics.split_vertices},
                    {"folded_triangles_left_out", statistics.folded},
                    {"holes_filled", holes.filled},
                    {"holes_filled_m2", holes.filled_area_m2},
                    {"holes_closed", holes.closed},
                    {"holes_closed_m2", holes.closed_area_m2},
                    {"borders_left_open", holes.left_open},
                    {"borders_not_fillable", holes.not_fillable},
                    {"seconds", seconds}}
                   .dump(2)
            << '\n';
  return 0;
}

}  // namespace

Command add_mesh_command(CLI::App& app) {
  auto arguments = std::make_shared<MeshArguments>();
  CLI::App& mesh = *app.add_subcommand("mesh", "Make a surface of triangles out of a cloud: dual contouring of its implicit surface");
  mesh.add_option("RESULT", arguments->source, "Folder as hermite reconstruct writes it, or any PLY of points with normals")->required();
  mesh.add_option("--out", arguments->out, "PLY file for the mesh (default: mesh.ply in that folder)");
  mesh.add_option("--cell", arguments->cell_mm, "Edge of a cell [mm], 2 to 100; 0: the distance of the points, within 5 and 40")
      ->capture_default_str();
  mesh.add_option("--min-part", arguments->least_part_cm2, "Leave out pieces that hang together with nothing and have less surface [cm^2]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  mesh.add_option("--support", arguments->options.field.support_spacings, "Radius of a point's support in distances of points")
      ->check(CLI::Range(1.5, 10.0))
      ->capture_default_str();
  CLI::Option* simplify =
      mesh.add_option("--simplify", arguments->simplify_mm, "Take fewer triangles where the surface moves by less than this [mm]")
          ->check(CLI::Range(0.01, 1000.0));
  mesh.add_option("--triangles", arguments->triangles, "With --simplify: not fewer than these")
      ->needs(simplify)
      ->check(CLI::Range(0, 1 << 30));
  mesh.add_option("--fill-holes", arguments->holes.width_m,
                  "Fill holes that are no wider than this [m] as the surface around them goes on; what is filled is marked")
      ->check(CLI::Range(0.001, kMostHoleWidth_m));
  mesh.add_flag("--close", arguments->holes.closes_all,
                "Close all that is open, for printing, wherever the surface ends, too; what is closed is marked");
  mesh.add_flag("!--smooth-edges", arguments->options.field.keep_edges, "Do not tell surfaces that meet in an edge from each other");
  return {&mesh, [arguments] { return run_mesh(*arguments); }};
}

}  // namespace hermite
