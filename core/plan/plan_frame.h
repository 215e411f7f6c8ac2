// The axes of a floor plan in a scan: up, the direction of most walls, and the heights of floor and
// ceiling. Pure functions. Any thread.
//
// Plan coordinates are metres: x and y along the floor, z up, with z = 0 on the floor.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::plan {

// Points of one surface within a cube of this size are joined to one facet.
inline constexpr double kFacet_m = 0.025;

// The mean of the points in one cube that face the same of six directions, in plan coordinates.
// Facets are about equally dense on all surfaces, so that their number is a measure of area.
struct PlanFacet {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit
  std::uint32_t submap = 0;                          // of one of the points
};

struct PlanFrame {
  Eigen::Matrix3d plan_from_world = Eigen::Matrix3d::Identity();  // rotation
  // Origin of the plan, in the world: on the floor, below the middle of the scan.
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  // Height above the floor of the ceiling; without one, that below which nearly all upright
  // surfaces are.
  double top_m = 0;
  bool has_ceiling = false;  // of at least 1 m²

  Eigen::Vector3d to_plan(const Eigen::Vector3d& at_m) const {
    return plan_from_world * (at_m - origin_m);
  }
  Eigen::Vector3d to_world(const Eigen::Vector3d& at_m) const {
    return plan_from_world.transpose() * at_m + origin_m;
  }
};

struct PlanSurface {
  PlanFrame frame;
  std::vector<PlanFacet> facets;  // in the order of their cubes
};

// Levels are horizontal surfaces as high as each other: points of one level are at most this far
// above or below it.
inline constexpr double kLevel_m = 0.05;
// Greatest vertical component of the normal of an upright surface.
inline constexpr double kUpright = 0.25;
// Least vertical component of the normal of a horizontal one.
inline constexpr double kLevelCosine = 0.9;

// `up` is a unit vector of the world. kInvalidArgument when the cloud has no floor of at least 0.5
// m², or less than 0.5 m² of upright surface; kTooLarge when it is more than 200 m wide.
Result<PlanSurface> plan_surface_of(const output::Cloud& cloud, const Eigen::Vector3d& up);

}  // namespace hermite::plan
