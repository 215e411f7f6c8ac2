#include "core/pipeline/cloud_points.h"

#include <algorithm>

namespace hermite::pipeline {

namespace {

// A surfel of a damaged checkpoint may be brighter than white.
std::uint8_t rounded(float value) {
  return static_cast<std::uint8_t>(std::min(value + 0.5f, 255.0f));
}

}  // namespace

output::CloudPoint to_cloud_point(const map::Surfel& surfel, const Rigid3& target_from_submap) {
  output::CloudPoint point;
  point.position_m =
      (target_from_submap * surfel.position_in_submap_m.cast<double>()).cast<float>();
  point.normal =
      (target_from_submap.rotation * -surfel.normal_in_submap.cast<double>()).cast<float>();
  point.color = {rounded(surfel.r), rounded(surfel.g), rounded(surfel.b)};
  point.confidence = surfel.confidence;
  point.curvature_max_per_m = surfel.curvature_max_per_m;
  point.curvature_min_per_m = surfel.curvature_min_per_m;
  point.radius_m = surfel.radius_m;
  point.submap = surfel.submap;
  return point;
}

map::Surfel to_surfel(const output::CloudPoint& point, std::uint32_t frame_number) {
  map::Surfel surfel;
  surfel.position_in_submap_m = point.position_m;
  surfel.normal_in_submap = -point.normal;
  surfel.radius_m = point.radius_m;
  surfel.confidence = point.confidence;
  surfel.curvature_max_per_m = point.curvature_max_per_m;
  surfel.curvature_min_per_m = point.curvature_min_per_m;
  surfel.r = point.color.r;
  surfel.g = point.color.g;
  surfel.b = point.color.b;
  surfel.created_frame = surfel.observed_frame = frame_number;
  return surfel;
}

}  // namespace hermite::pipeline
