#include "core/measure/area.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/math/principal_axes.h"
#include "core/measure/distance.h"

namespace hermite::measure {

namespace {

using Eigen::Vector2d;

// Least standard deviation of the corners across their best-fitting line; below it the area is
// meaningless.
constexpr double kLeastBreadth_m = 0.005;
// A corner this close to a side touches it.
constexpr double kOnLine_m = 1e-6;

struct FlatOutline {
  std::vector<Vector2d> corners;  // in the plane
  Eigen::Vector3d along, across;  // its axes, unit
  double breadth_m = 0;           // standard deviation of the corners along the second
};

FlatOutline flat_outline_of(std::span<const MeasuredPlace> corners) {
  std::vector<Eigen::Vector3d> positions_m;
  for (const MeasuredPlace& corner : corners) positions_m.push_back(corner.position_m);
  const PrincipalAxes axes = principal_axes(positions_m);
  FlatOutline outline;
  outline.along = axes.direction[0];
  outline.across = axes.direction[1];
  outline.breadth_m = axes.deviation[1];
  for (const Eigen::Vector3d& position : positions_m)
    outline.corners.emplace_back((position - axes.centre).dot(outline.along),
                                 (position - axes.centre).dot(outline.across));
  return outline;
}

// Returns 1 if `c` lies to the left of the line from `a` to `b`, -1 to the right, 0 on it.
int side_of(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double off_m = ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x()) / (b - a).norm();
  return off_m > kOnLine_m ? 1 : off_m < -kOnLine_m ? -1 : 0;
}

bool is_between(const Vector2d& a, const Vector2d& b, const Vector2d& on_line) {
  return (on_line - a).dot(on_line - b) <= 0;
}

// Returns whether the segments from a to b and from c to d have a point in common.
bool meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const int of_c = side_of(a, b, c), of_d = side_of(a, b, d), of_a = side_of(c, d, a),
            of_b = side_of(c, d, b);
  if (of_c * of_d < 0 && of_a * of_b < 0) return true;
  return (of_c == 0 && is_between(a, b, c)) || (of_d == 0 && is_between(a, b, d)) ||
         (of_a == 0 && is_between(c, d, a)) || (of_b == 0 && is_between(c, d, b));
}

std::string corner_number(std::size_t index, std::size_t count) {
  return std::to_string(index % count + 1);
}

// Returns std::nullopt if the outline is valid.
std::optional<Error> fault_of(const FlatOutline& outline, std::span<const MeasuredPlace> places) {
  const std::vector<Vector2d>& corners = outline.corners;
  const std::size_t count = corners.size();
  for (std::size_t i = 0; i < count; ++i)
    if ((places[i].position_m - places[(i + 1) % count].position_m).norm() < kLeastDistance_m)
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("corners {} and {} are the same place: they are less than 5 mm apart",
                      corner_number(i, count), corner_number(i + 1, count))};
  if (outline.breadth_m < kLeastBreadth_m)
    return Error{ErrorCode::kInvalidArgument, "the corners lie on one line: they have no area"};
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 2; j < count; ++j)
      if ((j + 1) % count != i &&
          meet(corners[i], corners[i + 1], corners[j], corners[(j + 1) % count]))
        return Error{ErrorCode::kInvalidArgument,
                     fmt::format("the outline crosses itself: its side from corner {} to {} meets "
                                 "that from {} to {}",
                                 corner_number(i, count), corner_number(i + 1, count),
                                 corner_number(j, count), corner_number(j + 1, count))};
  return std::nullopt;
}

}  // namespace

Result<Quantity> area_of(std::span<const MeasuredPlace> corners, const MapKnowledge& map) {
  const std::size_t count = corners.size();
  if (count < row_of(MeasureKind::kArea).least_points || count > kMostCorners)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("an area has 3 to {} corners, not {}", kMostCorners, count)};
  const FlatOutline outline = flat_outline_of(corners);
  if (const std::optional<Error> fault = fault_of(outline, corners)) return *fault;
  double doubled_m2 = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d &here = outline.corners[i], &next = outline.corners[(i + 1) % count];
    doubled_m2 += here.x() * next.y() - here.y() * next.x();
  }
  Quantity found;
  found.kind = MeasureKind::kArea;
  found.value = std::abs(doubled_m2) / 2;
  std::vector<Eigen::Vector3d> gradients;  // derivatives of the area by each corner [m]
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d beside =
        outline.corners[(i + 1) % count] - outline.corners[(i + count - 1) % count];
    gradients.push_back((outline.along * beside.y() - outline.across * beside.x()) *
                        (doubled_m2 < 0 ? -0.5 : 0.5));
    found.surface_sigma = std::hypot(
        found.surface_sigma, corners[i].normal_sigma_m * gradients[i].dot(corners[i].normal));
  }
  const Result<PoseError> drift = pose_error_of(corners, gradients, map);
  if (!drift.ok()) return drift.error();
  // The share applies to both dimensions of the area.
  found.pose_sigma = std::hypot(drift->sigma, 2 * length_share_of(map) * found.value);
  found.way_m = drift->way_m;
  found.half_width = kDeviationsOfConfidence * std::hypot(found.surface_sigma, found.pose_sigma);
  return found;
}

}  // namespace hermite::measure
