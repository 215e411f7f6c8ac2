// A keyframe joins the map: its features find the landmarks they are, the others with depth become new ones.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/sparse_map.h"

namespace hermite {

struct InsertResult {
  std::uint32_t keyframe = 0;           // its index in the map
  int matched_count = 0;                // features that are landmarks of before
  std::vector<std::uint32_t> created;   // landmarks that this keyframe is the first to see, ascending
  std::vector<std::uint32_t> repeated;  // landmarks that it is the second to see, ascending: those worth remembering (place_index.h)
};

// `keyframe` has its pose from dense tracking, good to some pixels, a submap of the map, and features; its landmark_of_feature is replaced.
// Looked for are the landmarks of the map's last keyframes, of those covisible with them and of the keyframes in `also` (a place found
// again), 30 keyframes at most. Keyframes come in the order of time. A pose that is not finite, or a submap the map does not have, is our
// own mistake.
InsertResult insert_keyframe(SparseMap& map, Keyframe keyframe, const std::vector<std::uint32_t>& also = {});

}  // namespace hermite
