// The blocks of the map that a view can show. Only these are processed, so the cost of a frame
// depends on its view and not on the size of the map.
#pragma once

#include "core/gpu/kernel.h"
#include "core/map/index_map.h"
#include "core/map/map_options.h"
#include "core/map/surfel_store.h"

namespace hermite::map {

class VisibleBlocks {
 public:
  VisibleBlocks(gpu::Device& device, const MapOptions& options);

  // Records the listing, in store.visible_blocks, of all blocks that may have surfels in view of
  // the camera that the store was set to (up to kFarthest_m), including those just appended by
  // fusion, and of one in several of the others, a different one in each frame. Blocks whose turn
  // for cleaning has come are first.
  void list(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera,
            std::uint32_t frame_number);

 private:
  const MapOptions options_;
  gpu::Kernel kernel_;
};

}  // namespace hermite::map
