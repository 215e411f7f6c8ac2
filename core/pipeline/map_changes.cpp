#include "core/pipeline/map_changes.h"

#include <algorithm>
#include <utility>

#include "core/pipeline/cloud_points.h"

namespace hermite::pipeline {

// Reports slots of the previous map that the new map lacks. `changes` holds all slots of the new
// map.
void MapChanges::report_slots_left(std::vector<output::SlotChange>& changes) {
  std::vector<bool> is_told(published.size(), false);
  for (const output::SlotChange& change : changes) is_told[change.slot] = true;
  for (std::uint32_t number = 0; number < published.size(); ++number) {
    if (!published[number] || is_told[number]) continue;
    published[number] = false;
    changes.push_back({number, false, {}});
  }
  std::ranges::sort(changes, {}, &output::SlotChange::slot);
}

std::vector<output::SlotChange> MapChanges::take(
    const map::SurfelStore& store, std::uint32_t frame_number,
    const std::function<bool(const map::Surfel&)>& is_published) {
  std::vector<output::SlotChange> changes;
  for (const auto& [number, surfel, changed_frame] : store.changed_blocks(taken_frame)) {
    if (changed_frame <= taken_frame) continue;
    if (published.size() <= number) published.resize(number + map::kSlotsPerBlock, false);
    const bool alive = is_published(surfel);
    if (alive || published[number])
      changes.push_back(
          {number, alive, alive ? to_cloud_point(surfel, Rigid3{}) : output::CloudPoint{}});
    published[number] = alive;
  }
  if (std::exchange(is_map_new, false)) report_slots_left(changes);
  taken_frame = frame_number;
  return changes;
}

}  // namespace hermite::pipeline
