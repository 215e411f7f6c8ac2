#include "server/mesh_file.h"

#include <chrono>
#include <filesystem>
#include <utility>

#include "core/mesh/simplify.h"
#include "core/output/mesh_ply.h"
#include "core/output/ply.h"
#include "server/ply_file.h"

namespace hermite::commands {

namespace {

output::Cloud read_points_with_normals(const std::string& path) {
  const output::PlyShape shape = read_ply_file(path);
  if (shape.normals.empty())
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         path +
             " has no points with normals (nx, ny, nz): the sides of its surface cannot be told"});
  return output::cloud_of(shape);
}

}  // namespace

std::string mesh_source_path(const std::string& result) {
  if (!std::filesystem::is_directory(result)) return result;
  return result +
         (std::filesystem::exists(result + "/surfels.ply") ? "/surfels.ply" : "/cloud.ply");
}

nlohmann::ordered_json make_mesh_file(const std::string& points_path, const MeshMaking& making,
                                      const std::string& mesh_path) {
  using Clock = std::chrono::steady_clock;
  output::Cloud cloud = read_points_with_normals(points_path);
  const std::size_t point_count = cloud.size();
  mesh::ContourStatistics statistics;
  mesh::HoleFillStatistics holes;
  const Clock::time_point start = Clock::now();
  output::TriangleMesh mesh =
      or_throw(mesh::contour(std::move(cloud), making.contour, {}, &statistics));
  if (making.simplify_mm > 0)
    mesh = or_throw(mesh::simplified(mesh, {making.simplify_mm / 1000, making.triangles}));
  if (making.holes.width_m > 0 || making.holes.closes_all)
    mesh = or_throw(mesh::holes_filled(mesh, making.holes, {}, &holes));
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  or_throw(output::write_file_atomically(mesh_path, output::format_mesh_ply(mesh)));
  return {{"mesh", mesh_path},
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
          {"seconds", seconds}};
}

}  // namespace hermite::commands
