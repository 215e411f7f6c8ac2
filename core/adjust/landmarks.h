// Insertion of a keyframe into the map: its features are matched with landmarks, and unmatched ones
// with depth become new landmarks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/sparse_map.h"

namespace hermite::adjust {

struct InsertResult {
  std::uint32_t keyframe = 0;          // its index in the map
  int matched_count = 0;               // features matched with existing landmarks
  std::vector<std::uint32_t> created;  // landmarks first seen by this keyframe, ascending
  // Landmarks now seen by a second keyframe, ascending: those worth indexing (place_index.h).
  std::vector<std::uint32_t> repeated;
};

// Inserts `keyframe`, which has a pose from dense tracking (accurate to some pixels), a submap of
// the map, and features; its landmark_of_feature is replaced. Matching searches the landmarks of
// the map's last keyframes, of those covisible with them and of the keyframes in `also` (a
// revisited place), at most 30 keyframes. Keyframes come in the order of time. A CHECK fails if the
// pose is not finite or the map has no such submap.
InsertResult insert_keyframe(SparseMap& map, Keyframe keyframe,
                             const std::vector<std::uint32_t>& also = {});

}  // namespace hermite::adjust
