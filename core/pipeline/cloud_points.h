// Conversion between surfels and cloud points. Surfel normals point away from the camera; the
// normals of clouds point towards it, as other programs expect.
#pragma once

#include <cstdint>

#include "core/map/surfel_store.h"
#include "core/math/rigid3.h"
#include "core/output/cloud.h"

namespace hermite::pipeline {

output::CloudPoint to_cloud_point(const map::Surfel& surfel, const Rigid3& target_from_submap);

// Returns a surfel of submap 0, as if first seen in that frame.
map::Surfel to_surfel(const output::CloudPoint& point, std::uint32_t frame_number);

}  // namespace hermite::pipeline
