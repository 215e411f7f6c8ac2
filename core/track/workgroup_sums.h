// How the passes of the odometry are divided into workgroups, each of which leaves its sums in a
// buffer, and how the host adds these (shaders/track). Values on the host. Any thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/gpu/device.h"
#include "shaders/shared/track.h"

namespace hermite::track {

inline constexpr std::uint32_t kMaxOdometryGroups = HERMITE_ODOMETRY_GROUPS;

// Adding up a workgroup's terms costs as much as several pixels of each of its threads. A CPU
// device gains nothing from more workgroups. On an H100, which has room for all of them at once,
// the passes of TUM fr1 take 0.28, 0.25, 0.23 and 0.23 ms a frame with 8, 4, 2 and 1 pixels; with
// fewer, the host has more sums to add.
inline std::uint32_t pixels_per_thread(const gpu::Device& device) {
  return device.info().kind == gpu::DeviceKind::kCpu ? 64 : 4;
}

// Returns the number of invocations for this many pixels each, as whole workgroups.
inline std::uint32_t odometry_threads(std::uint32_t pixel_count, std::uint32_t pixels_per_thread) {
  const std::uint32_t pixels_per_group = pixels_per_thread * HERMITE_ODOMETRY_GROUP_SIZE;
  return HERMITE_ODOMETRY_GROUP_SIZE *
         std::clamp((pixel_count + pixels_per_group - 1) / pixels_per_group, 1u,
                    kMaxOdometryGroups);
}

// Returns the sums over all workgroups of a dispatch, added in order.
template <shared::uint N>
std::array<double, N> sum_of_groups(std::span<const float> partial_sums, std::uint32_t threads,
                                    std::size_t first_group = 0) {
  std::array<double, N> sums{};
  for (std::size_t group = first_group; group < first_group + threads / HERMITE_ODOMETRY_GROUP_SIZE;
       ++group)
    for (std::size_t term = 0; term < N; ++term)
      sums[term] += static_cast<double>(partial_sums[group * N + term]);
  return sums;
}

}  // namespace hermite::track
