#include "core/mesh/simplify.h"

#include <fmt/core.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "core/mesh/mesh_parts.h"
#include "core/output/mesh_check.h"

namespace hermite::mesh {
namespace {

constexpr double kLeastError_m = 1e-5, kMostError_m = 1;
constexpr std::int64_t kMostTriangles = std::int64_t{1} << 30;

Status check_simplification(const output::TriangleMesh& mesh, const SimplifyOptions& options) {
  if (!(options.most_error_m >= kLeastError_m && options.most_error_m <= kMostError_m))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("error of {:f} m: expected 0.00001 to 1", options.most_error_m)};
  if (options.least_triangles < 0 || options.least_triangles > kMostTriangles)
    return Error{ErrorCode::kInvalidArgument,
                 std::to_string(options.least_triangles) + " triangles: expected 0 to 2^30"};
  if (options.triangles_of_last_pass < 2)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("a last pass of {} triangles: expected 2 at least",
                             options.triangles_of_last_pass)};
  if (!mesh.pages.empty())
    return Error{ErrorCode::kInvalidArgument,
                 "a mesh is simplified before it is textured: its texture would not fit any more"};
  return output::check_mesh(mesh);
}

// Collapses edges until `least` triangles are left or no more edge can be collapsed within
// `most_error`, a fraction of the mesh's extent. Returns the error that this caused, as the same
// fraction.
float simplify_pass(output::TriangleMesh& mesh, std::size_t least, float most_error) {
  const std::vector<output::TriangleCorners> before = mesh.triangles;
  float error = 0;
  const std::size_t left =
      meshopt_simplify(mesh.triangles.front().data(), before.front().data(), 3 * before.size(),
                       mesh.positions_m.front().data(), mesh.positions_m.size(),
                       sizeof(Eigen::Vector3f), 3 * least, most_error, 0, &error);
  mesh.triangles.resize(left / 3);
  return error;
}

}  // namespace

Result<output::TriangleMesh> simplified(const output::TriangleMesh& mesh,
                                        const SimplifyOptions& options,
                                        const MeshProgress& progress) {
  if (const Status status = check_simplification(mesh, options); !status.ok())
    return status.error();
  output::TriangleMesh result = mesh;
  if (mesh.triangles.empty()) return result;
  const float extent_m = meshopt_simplifyScale(mesh.positions_m.front().data(),
                                               mesh.positions_m.size(), sizeof(Eigen::Vector3f));
  if (!(extent_m > 0)) return result;
  const auto goes_on = [&](double done) { return !progress || progress(done); };
  const auto least = static_cast<std::size_t>(options.least_triangles),
             last = static_cast<std::size_t>(options.triangles_of_last_pass);
  float error_left = static_cast<float>(options.most_error_m) / extent_m;
  double done = 0;
  for (bool halved = true; halved && result.triangles.size() > last;) {
    if (!goes_on(done)) return Error{ErrorCode::kBusy, "simplifying was stopped"};
    const std::size_t before = result.triangles.size(), half = std::max(before / 2, least);
    const float error = simplify_pass(result, half, error_left);
    // Quadrics add up squared distances.
    error_left = std::sqrt(std::max(0.0f, error_left * error_left - error * error));
    halved = error_left > 0 && half > least && result.triangles.size() <= half + half / 16;
    done += (1 - done) / 2;
  }
  if (!goes_on(done)) return Error{ErrorCode::kBusy, "simplifying was stopped"};
  if (error_left > 0 && result.triangles.size() > least) simplify_pass(result, least, error_left);
  if (result.triangles.empty()) return result;
  // Collapses may bring parts of the surface into contact.
  split_touching_fans(result);
  remove_unused_vertices(result);
  return result;
}

}  // namespace hermite::mesh
