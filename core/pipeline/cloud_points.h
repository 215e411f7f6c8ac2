// Surfels as points of a cloud and back. Inside, normals point away from the camera; outside, everybody expects them towards it.
#pragma once

#include <cstdint>

#include "core/map/surfel_store.h"
#include "core/math/rigid3.h"
#include "core/output/cloud.h"

namespace hermite {

CloudPoint to_cloud_point(const Surfel& surfel, const Rigid3& target_from_submap);

// Of submap 0, as if first seen in that frame.
Surfel to_surfel(const CloudPoint& point, std::uint32_t frame_number);

}  // namespace hermite
