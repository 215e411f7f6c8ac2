#include "core/map/index_map.h"

namespace hermite::map {

namespace {

std::vector<gpu::Kernel> kernels_of(gpu::Device& device, int passes) {
  std::vector<gpu::Kernel> kernels;
  if (passes == 1) kernels.emplace_back(device, "map/index_nearest");
  if (passes == 2) kernels.emplace_back(device, "map/index_depth");
  if (passes == 2) kernels.emplace_back(device, "map/index_id");
  return kernels;
}

}  // namespace

IndexMap::IndexMap(gpu::Device& device, const shared::Intrinsics& camera, int passes)
    : passes_(kernels_of(device, passes)),
      surfel_kernel_(device, "map/index_surfel"),
      nearest_(device, static_cast<std::size_t>(camera.width) * camera.height, "index map"),
      cells_(device, static_cast<std::size_t>(camera.width) * camera.height, "index map") {}

IndexMap::IndexMap(gpu::Device& device, const shared::Intrinsics& camera)
    : IndexMap(device, camera, device.info().has_64_bit_atomics ? 1 : 2) {}

void IndexMap::build(gpu::Commands& commands, const SurfelStore& store,
                     const shared::Intrinsics& camera, double min_confidence) {
  commands.fill(nearest_, kNoSurfel);
  for (const gpu::Kernel& pass : passes_)
    commands.dispatch_indirect(
        pass, {store.visible_blocks},
        shared::IndexParams{camera, static_cast<float>(min_confidence), kFarthest_m},
        {{"position_confidence", store.positions},
         {"attributes", store.attributes},
         {"camera_from_submap", store.camera_from_submap},
         {"nearest", nearest_},
         {"visible_blocks", store.visible_blocks}});
}

void IndexMap::describe(gpu::Commands& commands, const SurfelStore& store,
                        const shared::Intrinsics& camera) {
  commands.dispatch(surfel_kernel_, {camera.width * camera.height}, camera,
                    {{"position_confidence", store.positions},
                     {"attributes", store.attributes},
                     {"camera_from_submap", store.camera_from_submap},
                     {"nearest", nearest_},
                     {"cells", cells_}});
}

}  // namespace hermite::map
