// Whether what an image shows recurs elsewhere in the map, as in a row of desks that are alike.
// Then the image cannot tell where the camera is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/adjust/place_index.h"
#include "core/adjust/sparse_map.h"

namespace hermite::adjust {

// Numbers of features with depth that have a landmark of the same appearance.
struct Repetition {
  std::size_t here = 0;  // where the given pose places them
  // Where another pose of the camera would place them, at least half a metre from there.
  std::size_t elsewhere = 0;
};

// Returns whether these numbers prove the pose: enough is here, and clearly less elsewhere.
bool is_distinctive(const Repetition& repetition);

// Returns the numbers for an image from this pose, and for the other pose that explains most of it,
// by landmarks that one of the first `known_keyframes` keyframes has seen. Deterministic.
// Thread-safe.
Repetition repetition_of(const SparseMap& map, const PlaceIndex& index,
                         const std::vector<Feature>& features, const Rigid3& world_from_camera,
                         std::int64_t known_keyframes);

}  // namespace hermite::adjust
