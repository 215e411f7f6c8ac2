// Which surfel slots have changed since the changes were last taken, for mirrors of the map
// elsewhere. One thread at a time, the device's.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/map/surfel_store.h"
#include "core/output/cloud.h"

namespace hermite::pipeline {

struct MapChanges {
  // Returns the slots that have changed since the last call, in slot order and submap frames, in a
  // map of `frame_number` frames. A slot is alive if `is_published` accepts its surfel. Throws
  // SetupError when the device fails.
  std::vector<output::SlotChange> take(const map::SurfelStore& store, std::uint32_t frame_number,
                                       const std::function<bool(const map::Surfel&)>& is_published);

  // Call when an empty map begins; `is_another`: it replaces one whose changes were taken.
  void begin_map(bool is_another) {
    taken_frame = 0;
    is_map_new = is_another;
  }

  // The next take() returns everything, for a mirror that starts anew.
  void forget() {
    taken_frame = 0;
    published.clear();
  }

  std::uint32_t taken_frame = 0;  // number of frames in the map at the last take()
  std::vector<bool> published;    // by slot: take() has reported it alive
  // Since the last take(): some published slots may not exist any more.
  bool is_map_new = false;

 private:
  void report_slots_left(std::vector<output::SlotChange>& changes);
};

}  // namespace hermite::pipeline
