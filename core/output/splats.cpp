#include "core/output/splats.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/output/cloud_check.h"
#include "core/output/spacing.h"

namespace hermite::output {
namespace {

constexpr float kHarmonic0 = 0.28209479f;  // 1 / (2 sqrt(pi))
constexpr float kSplatOpacity = 0.95f;
constexpr float kThinnest = 0.1f;          // relative to the other two axes
constexpr float kSmallestSplat_m = 1e-4f;  // of coincident points; keeps its logarithm finite
constexpr float kLoneSplat_m = 0.005f;     // of a point without neighbours and radius
constexpr float kShortestNormal = 0.5f;
constexpr std::size_t kSplatFloats = 17;

// Standard deviations along the surface and perpendicular to it [m].
struct SplatSize {
  float along = 0, across = 0;
};

SplatSize splat_size(const CloudPoint& point, float spacing_m) {
  if (point.radius_m > 0)
    spacing_m = spacing_m > 0 ? std::min(spacing_m, point.radius_m) : point.radius_m;
  const float along =
      std::max(kSplatSigmas * (spacing_m > 0 ? spacing_m : kLoneSplat_m), kSmallestSplat_m);
  const float bend =
      std::max(std::abs(point.curvature_max_per_m), std::abs(point.curvature_min_per_m));
  return {along, std::clamp(0.5f * bend * along * along, kThinnest * along, along)};
}

std::array<float, kSplatFloats> splat_of(const CloudPoint& point, float spacing_m) {
  const SplatSize size = splat_size(point, spacing_m);
  const Eigen::Vector3f normal = point.normal.stableNormalized();
  const Eigen::Quaternionf turn =
      Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitZ(), normal).normalized();
  const auto harmonic = [](std::uint8_t channel) {
    return (static_cast<float>(channel) / 255 - 0.5f) / kHarmonic0;
  };
  return {point.position_m.x(),
          point.position_m.y(),
          point.position_m.z(),
          normal.x(),
          normal.y(),
          normal.z(),
          harmonic(point.color.r),
          harmonic(point.color.g),
          harmonic(point.color.b),
          std::log(kSplatOpacity / (1 - kSplatOpacity)),
          std::log(size.along),
          std::log(size.along),
          std::log(size.across),
          turn.w(),
          turn.x(),
          turn.y(),
          turn.z()};
}

}  // namespace

Result<std::string> format_splats(const Cloud& cloud) {
  if (const Status status = check_cloud_with_points(cloud); !status.ok()) return status.error();
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud[i].normal.stableNorm() < kShortestNormal)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("cloud: point {} has no normal (nx, ny, nz), which a splat needs to "
                               "lie in its surface",
                               i)};
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\n"
      "comment Hermite: surfels as 3D Gaussians, metres, y down\n"
      "element vertex {}\n",
      cloud.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
                           "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    bytes += fmt::format("property float {}\n", name);
  bytes += "end_header\n";
  bytes.reserve(bytes.size() + cloud.size() * kSplatFloats * sizeof(float));
  const std::vector<float> spacings_m = point_spacings_m(cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::array<float, kSplatFloats> splat = splat_of(cloud[i], spacings_m[i]);
    bytes.append(reinterpret_cast<const char*>(splat.data()), sizeof splat);
  }
  return bytes;
}

}  // namespace hermite::output
