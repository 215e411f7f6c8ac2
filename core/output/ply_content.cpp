// Conversion of a PLY file to a cloud or a mesh.
#include "core/output/mean_normals.h"
#include "core/output/ply_reader.h"

namespace hermite::output {
namespace {

constexpr Rgb8 kWhite{255, 255, 255};

}  // namespace

Cloud cloud_of(const PlyShape& shape) {
  Cloud cloud(shape.positions.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    CloudPoint& point = cloud[i];
    point.position_m = shape.positions[i];
    point.color = shape.colors.empty() ? kWhite : shape.colors[i];
    if (!shape.normals.empty()) point.normal = shape.normals[i];
    if (!shape.radii.empty()) point.radius_m = shape.radii[i];
    if (!shape.confidences.empty()) point.confidence = shape.confidences[i];
    if (!shape.curvatures.empty()) point.curvature_max_per_m = shape.curvatures[i].x();
    if (!shape.curvatures.empty()) point.curvature_min_per_m = shape.curvatures[i].y();
    if (!shape.submaps.empty()) point.submap = shape.submaps[i];
  }
  return cloud;
}

Result<TriangleMesh> mesh_of(PlyShape shape) {
  if (shape.triangles.empty())
    return Error{ErrorCode::kNotFound, "PLY: there are no faces, only points"};
  TriangleMesh mesh;
  mesh.normals = shape.normals.empty() ? mean_normals(shape.positions, shape.triangles)
                                       : std::move(shape.normals);
  mesh.colors = shape.colors.empty() ? std::vector<Rgb8>(shape.positions.size(), kWhite)
                                     : std::move(shape.colors);
  mesh.positions_m = std::move(shape.positions);
  mesh.triangles = std::move(shape.triangles);
  mesh.is_filled = std::move(shape.is_filled);
  return mesh;
}

}  // namespace hermite::output
