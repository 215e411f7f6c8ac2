// Moves submaps so that a loop closes, or so that two components of the map become one.
#pragma once

#include <optional>

#include "core/adjust/submap_atlas.h"

namespace hermite::adjust {

struct ClosedLoop {
  bool has_moved = false;  // submaps; not if the loop says no more than the map does already
  bool joins_components = false;
};

// Adds the loop to the graph and bends the map so that it closes; of two components, the older one
// stays where it is. Then layout.closure_count is one more. Returns nullopt, with nothing changed,
// if other links contradict the loop, or if it joins components that are farther apart than the
// camera can have come. Which submaps are active must be updated afterwards.
std::optional<ClosedLoop> close_loop(SubmapAtlas& atlas, const SubmapLink& loop);

// Returns the world pose of the submap where the loop starts, according to the loop.
Rigid3 placed_by(const SparseMap& map, const SubmapLink& loop);

// Returns whether a correction is smaller than the noise of tracking, so that it is not worth
// another prediction of the surface.
bool is_small_correction(const Rigid3& motion);

}  // namespace hermite::adjust
