#include "core/map/visible_blocks.h"

namespace hermite::map {

namespace {

// Out of view only the age of surfels changes, so a block is cleaned this many times less often
// than in view.
constexpr int kTurnsOutOfView = 16;

}  // namespace

VisibleBlocks::VisibleBlocks(gpu::Device& device, const MapOptions& options)
    : options_(options), kernel_(device, "map/visible") {}

void VisibleBlocks::list(gpu::Commands& commands, const SurfelStore& store,
                         const shared::Intrinsics& camera, std::uint32_t frame_number) {
  const shared::VisibleParams params{
      camera,
      kFarthest_m,
      static_cast<float>(options_.fuse_depth_gate_m),
      frame_number,
      static_cast<shared::uint>(options_.clean_interval_frames),
      static_cast<shared::uint>(kTurnsOutOfView * options_.clean_interval_frames)};
  commands.dispatch(kernel_, {256}, params,
                    {{"bounds", store.bounds},
                     {"camera_from_submap", store.camera_from_submap},
                     {"state", store.state},
                     {"visible_blocks", store.visible_blocks}});
}

}  // namespace hermite::map
