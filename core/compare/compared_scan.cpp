#include "core/compare/compared_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "core/base/printf_text.h"

namespace hermite::compare {

namespace {

using Eigen::Vector3d;

// Surfels are a few millimetres to two centimetres apart: a bin has some tens of them.
constexpr double kBin_m = 0.04;
constexpr double kMostBins = 1 << 19;
constexpr double kOutermostShare = 0.01;
constexpr int kGrey = 3;  // of 255: colours that differ less are one colour

double extent_of(const output::Cloud& surfels) {
  Vector3d sides = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    values.reserve(surfels.size());
    for (const output::CloudPoint& point : surfels) values.push_back(point.position_m[axis]);
    const auto outer =
        static_cast<std::ptrdiff_t>(kOutermostShare * static_cast<double>(values.size()));
    std::nth_element(values.begin(), values.begin() + outer, values.end());
    const float low = values[static_cast<std::size_t>(outer)];
    std::nth_element(values.begin(), values.end() - 1 - outer, values.end());
    sides[axis] = double{*(values.end() - 1 - outer)} - double{low};
  }
  return sides.norm();
}

bool has_colors(const output::Cloud& surfels) {
  const Rgb8& first = surfels.front().color;
  const auto differs = [](int a, int b) { return std::abs(a - b) > kGrey; };
  return std::any_of(surfels.begin(), surfels.end(), [&](const output::CloudPoint& point) {
    return differs(point.color.r, first.r) || differs(point.color.g, first.g) ||
           differs(point.color.b, first.b);
  });
}

bool is_usable(const output::CloudPoint& point) {
  if (!point.position_m.allFinite() || !point.normal.allFinite()) return false;
  return point.normal.squaredNorm() > 1e-6f;
}

Status check(const output::Cloud& surfels, double extent_m, std::size_t left_out,
             const std::string& name) {
  if (surfels.size() < kLeastSurfels)
    return Error{
        ErrorCode::kInvalidArgument,
        printf_text(
            ": it has %zu usable points with normals (%zu were left out); at least %zu are needed",
            surfels.size(), left_out, kLeastSurfels)
            .insert(0, name)};
  if (!(extent_m >= kLeastExtent_m) || !(extent_m <= kMostExtent_m))
    return Error{
        ErrorCode::kInvalidArgument,
        printf_text(": it extends over %.4g m, allowed are %g to %g m; positions must be in metres",
                    extent_m, kLeastExtent_m, kMostExtent_m)
            .insert(0, name)};
  return Done{};
}

// Which of six sides a normal faces.
std::uint64_t side_of(const Eigen::Vector3f& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint64_t>(2 * axis + (normal[axis] < 0 ? 1 : 0));
}

std::uint64_t key_of(const output::CloudPoint& point, double spacing_m) {
  const Eigen::Vector3i cube =
      (point.position_m.cast<double>() / spacing_m).array().floor().cast<int>();
  const auto part = [](int value) {
    return static_cast<std::uint64_t>(value + (1 << 19)) & 0xfffffu;
  };
  return part(cube.x()) | part(cube.y()) << 20 | part(cube.z()) << 40 | side_of(point.normal) << 60;
}

struct CubeSide {
  double nearest2_m2 = std::numeric_limits<double>::infinity();
  double count = 0;
};

}  // namespace

Result<ComparedScan> ComparedScan::create(output::Cloud cloud, dataset::Trajectory trajectory,
                                          const std::string& name) {
  ComparedScan scan(kBin_m);
  const std::size_t count = cloud.size();
  std::erase_if(cloud, [](const output::CloudPoint& point) { return !is_usable(point); });
  scan.left_out_count_ = count - cloud.size();
  const bool has_confidence =
      std::any_of(cloud.begin(), cloud.end(),
                  [](const output::CloudPoint& point) { return point.confidence > 0; });
  for (output::CloudPoint& point : cloud) {
    point.normal.normalize();
    if (!has_confidence) point.confidence = 1;
  }
  scan.extent_m_ = cloud.size() < kLeastSurfels ? 0 : extent_of(cloud);
  if (const Status status = check(cloud, scan.extent_m_, scan.left_out_count_, name); !status.ok())
    return status.error();
  if (const Status status = dataset::validate(trajectory, name); !status.ok())
    return status.error();
  for (const output::CloudPoint& point : cloud)
    if (!(point.position_m.cwiseAbs().maxCoeff() < kBin_m * kMostBins))
      return Error{ErrorCode::kTooLarge,
                   name + printf_text(": a point lies farther than %.0f m from the origin",
                                      kBin_m * kMostBins)};
  for (std::size_t i = 0; i < cloud.size(); ++i)
    scan.grid_.insert(static_cast<std::uint32_t>(i), cloud[i].position_m);
  scan.has_color_ = has_colors(cloud);
  scan.surfels_ = std::move(cloud);
  scan.trajectory_ = std::move(trajectory);
  return scan;
}

void ComparedScan::append_near(const Vector3d& point, double reach_m,
                               std::vector<output::CloudPoint>& found) const {
  for_each_near(point, reach_m, [&](const output::CloudPoint& surfel) { found.push_back(surfel); });
}

SurfaceSamples surface_samples(const output::Cloud& surfels, double spacing_m, std::size_t most) {
  std::unordered_map<std::uint64_t, std::uint32_t> index_of_key;
  std::vector<SurfaceSample> samples;
  std::vector<CubeSide> sides;
  std::vector<std::uint32_t> of_surfel(surfels.size());
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const output::CloudPoint& point = surfels[i];
    const Vector3d position_m = point.position_m.cast<double>();
    const auto [entry, is_new] = index_of_key.try_emplace(
        key_of(point, spacing_m), static_cast<std::uint32_t>(samples.size()));
    if (is_new) {
      samples.emplace_back();
      sides.emplace_back();
    }
    if (samples.size() > most) return surface_samples(surfels, 1.2 * spacing_m, most);
    SurfaceSample& sample = samples[entry->second];
    CubeSide& side = sides[entry->second];
    const Vector3d middle = ((position_m / spacing_m).array().floor() + 0.5).matrix() * spacing_m;
    if (const double distance2_m2 = (position_m - middle).squaredNorm();
        distance2_m2 < side.nearest2_m2) {
      side.nearest2_m2 = distance2_m2;
      sample.position_m = position_m;
      sample.normal = point.normal.cast<double>();
      sample.surfel = static_cast<std::uint32_t>(i);
    }
    sample.color += Vector3d(point.color.r, point.color.g, point.color.b);
    ++side.count;
    of_surfel[i] = entry->second;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].color /= sides[i].count;
  return {std::move(samples), std::move(of_surfel), spacing_m};
}

output::Cloud moved_cloud(const output::Cloud& cloud, const Rigid3& target_from_source) {
  output::Cloud moved = cloud;
  for (output::CloudPoint& point : moved) {
    point.position_m = (target_from_source * point.position_m.cast<double>().eval()).cast<float>();
    point.normal = (target_from_source.rotation * point.normal.cast<double>().eval()).cast<float>();
  }
  return moved;
}

dataset::Trajectory moved_trajectory(const dataset::Trajectory& trajectory,
                                     const Rigid3& target_from_source) {
  dataset::Trajectory moved = trajectory;
  for (dataset::TimedPose& pose : moved)
    pose.world_from_camera = target_from_source * pose.world_from_camera;
  return moved;
}

}  // namespace hermite::compare
