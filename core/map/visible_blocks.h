// Which blocks of the map's slots a view can show: what the passes over the map look at, so that a frame costs what it sees and not what
// has been scanned before.
#pragma once

#include "core/gpu/kernel.h"
#include "core/map/index_map.h"
#include "core/map/map_options.h"
#include "core/map/surfel_store.h"

namespace hermite {

class VisibleBlocks {
 public:
  VisibleBlocks(gpu::Device& device, const MapOptions& options);

  // Records: lists in store.visible_blocks all blocks that may have surfels in view of the camera that the store was set to (up to
  // kFarthest_m), those that fusion has just appended to included, and one in so many of the others, another one in each frame. Those whose
  // turn for cleaning has come are first.
  void list(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera, std::uint32_t frame_number);

 private:
  const MapOptions options_;
  gpu::Kernel kernel_;
};

}  // namespace hermite
