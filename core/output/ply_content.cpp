// What a PLY file is a file of.
#include <Eigen/Geometry>

#include "core/output/ply_reader.h"

namespace hermite {
namespace {

constexpr Rgb8 kWhite{255, 255, 255};

std::vector<Eigen::Vector3f> mean_normals(const PlyShape& shape) {
  std::vector<Eigen::Vector3f> normals(shape.positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : shape.triangles) {
    const Eigen::Vector3f& corner = shape.positions[a];
    const Eigen::Vector3f twice_area = (shape.positions[b] - corner).cross(shape.positions[c] - corner);
    for (const std::uint32_t vertex : {a, b, c}) normals[vertex] += twice_area;
  }
  for (Eigen::Vector3f& normal : normals) normal.stableNormalize();
  return normals;
}

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
  if (shape.triangles.empty()) return Error{ErrorCode::kNotFound, "PLY: there are no faces, only points"};
  TriangleMesh mesh;
  mesh.normals = shape.normals.empty() ? mean_normals(shape) : std::move(shape.normals);
  mesh.colors = shape.colors.empty() ? std::vector<Rgb8>(shape.positions.size(), kWhite) : std::move(shape.colors);
  mesh.positions_m = std::move(shape.positions);
  mesh.triangles = std::move(shape.triangles);
  mesh.is_filled = std::move(shape.is_filled);
  return mesh;
}

}  // namespace hermite
