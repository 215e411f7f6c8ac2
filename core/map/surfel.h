// A surfel as plain values, and its conversion to and from the GPU layout (shaders/shared/map.h).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "shaders/shared/map.h"

namespace hermite::map {

inline constexpr std::uint32_t kSlotsPerBlock = 256;

struct Surfel {
  Eigen::Vector3f position_in_submap_m;
  Eigen::Vector3f normal_in_submap;  // unit length, away from the camera that saw it
  float radius_m = 0;
  float confidence = 0;  // 0: the slot is free
  float curvature_max_per_m = 0, curvature_min_per_m = 0;
  float r = 0, g = 0, b = 0;  // 0 to 255, in steps of 1/8, 1/8 and 1/4
  std::uint32_t submap = 0;
  std::uint32_t created_frame = 0, observed_frame = 0;
};

// Packs everything except position, confidence and times.
shared::SurfelAttributes pack_attributes(const Surfel& surfel);
Surfel unpack(const shared::vec4& position_confidence, const shared::SurfelAttributes& attributes,
              const shared::uvec2& times);

// Returns the bounds of each block of surfels, where the first surfel begins a block; surfels
// without confidence do not count.
std::vector<shared::BlockBounds> bounds_of(std::span<const Surfel> surfels);

}  // namespace hermite::map
