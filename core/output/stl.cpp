#include "core/output/stl.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <array>
#include <limits>

#include "core/output/axes.h"
#include "core/output/mesh_check.h"

namespace hermite::output {
namespace {

constexpr float kMmPerMetre = 1000;
constexpr std::size_t kStlHeader_bytes = 80, kStlTriangle_bytes = 50;
// It must not start with "solid", by which programs recognise text files.
constexpr const char* kStlHeader = "Hermite: millimetres, z up";

}  // namespace

Result<std::string> format_stl(const TriangleMesh& mesh) {
  if (const Status status = check_mesh_with_triangles(mesh); !status.ok()) return status.error();
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    return Error{
        ErrorCode::kTooLarge,
        fmt::format("STL: {} triangles, the format ends at 4294967295", mesh.triangles.size())};
  std::string bytes = kStlHeader;
  bytes.resize(kStlHeader_bytes, ' ');
  bytes.reserve(kStlHeader_bytes + 4 + mesh.triangles.size() * kStlTriangle_bytes);
  const auto append = [&bytes](const void* values, std::size_t size) {
    bytes.append(static_cast<const char*>(values), size);
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  append(&count, sizeof count);
  for (const TriangleCorners& corners : mesh.triangles) {
    std::array<Eigen::Vector3f, 3> at_mm;
    for (std::size_t k = 0; k < 3; ++k) at_mm[k] = kMmPerMetre * z_up(mesh.positions_m[corners[k]]);
    Eigen::Vector3f normal = (at_mm[1] - at_mm[0]).cross(at_mm[2] - at_mm[0]);
    normal.stableNormalize();
    append(normal.data(), 3 * sizeof(float));
    for (const Eigen::Vector3f& point : at_mm) append(point.data(), 3 * sizeof(float));
    bytes.append(2, '\0');  // "attribute byte count", whose meaning is not standardised
  }
  return bytes;
}

}  // namespace hermite::output
