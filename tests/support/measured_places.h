// Places of a result and what is known of it, for tests of what is measured between them. Header
// only.
#pragma once

#include <initializer_list>

#include "core/measure/pose_error.h"

namespace hermite::test {

inline measure::MeasuredPlace place_at(const Eigen::Vector3d& position_m,
                                       const Eigen::Vector3d& normal, double sigma_m = 0.001) {
  measure::MeasuredPlace place;
  place.position_m = position_m;
  place.normal = normal;
  place.normal_sigma_m = sigma_m;
  return place;
}

// By a camera that looks along z from places along x.
inline measure::MapKnowledge seen_from(std::initializer_list<double> xs) {
  dataset::Trajectory trajectory;
  for (const double x : xs)
    trajectory.push_back({static_cast<double>(trajectory.size()),
                          Rigid3{Eigen::Quaterniond::Identity(), {x, 0, 0}}});
  return {measure::CameraWay(trajectory), 1, false};
}

}  // namespace hermite::test
