#include "core/mesh/simplify.h"

#include <meshoptimizer.h>

#include <cstddef>
#include <string>
#include <vector>

#include "core/mesh/mesh_parts.h"
#include "core/output/mesh_check.h"

namespace hermite {
namespace {

constexpr double kLeastError_m = 1e-5, kMostError_m = 1;
constexpr std::int64_t kMostTriangles = std::int64_t{1} << 30;

Status check_simplification(const TriangleMesh& mesh, const SimplifyOptions& options) {
  if (!(options.most_error_m >= kLeastError_m && options.most_error_m <= kMostError_m))
    return Error{ErrorCode::kInvalidArgument, "error of " + std::to_string(options.most_error_m) + " m: expected 0.00001 to 1"};
  if (options.least_triangles < 0 || options.least_triangles > kMostTriangles)
    return Error{ErrorCode::kInvalidArgument, std::to_string(options.least_triangles) + " triangles: expected 0 to 2^30"};
  if (!mesh.pages.empty())
    return Error{ErrorCode::kInvalidArgument, "a mesh is simplified before it is textured: its texture would not fit any more"};
  return check_mesh(mesh);
}

}  // namespace

Result<TriangleMesh> simplified(const TriangleMesh& mesh, const SimplifyOptions& options) {
  if (const Status status = check_simplification(mesh, options); !status.ok()) return status.error();
  TriangleMesh result = mesh;
  if (mesh.triangles.empty()) return result;
  const float* const positions_m = mesh.positions_m.front().data();
  const std::size_t count = mesh.positions_m.size(), indices = 3 * mesh.triangles.size();
  const float extent_m = meshopt_simplifyScale(positions_m, count, sizeof(Eigen::Vector3f));
  if (!(extent_m > 0)) return result;
  const std::size_t left = meshopt_simplify(result.triangles.front().data(), mesh.triangles.front().data(), indices, positions_m, count,
                                            sizeof(Eigen::Vector3f), 3 * static_cast<std::size_t>(options.least_triangles),
                                            static_cast<float>(options.most_error_m) / extent_m, 0, nullptr);
  result.triangles.resize(left / 3);
  // What has collapsed may meet what it did not meet before.
  split_touching_fans(result);
  remove_unused_vertices(result);
  return result;
}

}  // namespace hermite
