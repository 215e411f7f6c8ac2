#include "core/map/index_map.h"

namespace hermite {

IndexMap::IndexMap(gpu::Device& device, const shared::Intrinsics& camera)
    : depth_kernel_(device, "map/index_depth"),
      id_kernel_(device, "map/index_id"),
      surfel_kernel_(device, "map/index_surfel"),
      depth_bits_(device, static_cast<std::size_t>(camera.width) * camera.height, "index map"),
      ids_(device, static_cast<std::size_t>(camera.width) * camera.height, "index map"),
      cells_(device, static_cast<std::size_t>(camera.width) * camera.height, "index map") {}

void IndexMap::build(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera, double min_confidence) {
  commands.fill(depth_bits_, kNoSurfel);
  commands.fill(ids_, kNoSurfel);
  const shared::IndexParams params{camera, static_cast<float>(min_confidence), kFarthest_m};
  for (const gpu::Kernel* kernel : {&depth_kernel_, &id_kernel_})
    commands.dispatch_indirect(*kernel, {store.visible_blocks}, params,
                               {store.positions, store.attributes, store.camera_from_submap, depth_bits_, ids_, store.visible_blocks});
}

void IndexMap::describe(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera) {
  commands.dispatch(surfel_kernel_, {camera.width * camera.height}, camera,
                    {store.positions, store.attributes, store.camera_from_submap, ids_, cells_});
}

}  // namespace hermite
