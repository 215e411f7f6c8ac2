#include "core/map/index_map.h"

namespace hermite {

namespace {

// Beyond this a surfel covers less than a pixel of any supported camera.
constexpr float kFarthest_m = 20.0f;

}  // namespace

IndexMap::IndexMap(gpu::Device& device, const shared::Intrinsics& camera)
    : depth_kernel_(device, "map/index_depth"),
      id_kernel_(device, "map/index_id"),
      depth_bits_(device, static_cast<std::size_t>(camera.width) * camera.height, "index map"),
      ids_(device, static_cast<std::size_t>(camera.width) * camera.height, "index map") {}

void IndexMap::build(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera, std::uint32_t slot_count,
                     double min_confidence) {
  commands.fill(depth_bits_, kNoSurfel);
  commands.fill(ids_, kNoSurfel);
  if (slot_count == 0) return;
  const shared::IndexParams params{camera, static_cast<float>(min_confidence), kFarthest_m, slot_count};
  for (const gpu::Kernel* kernel : {&depth_kernel_, &id_kernel_})
    commands.dispatch(*kernel, {slot_count}, params, {store.positions, store.attributes, store.camera_from_submap, depth_bits_, ids_});
}

}  // namespace hermite
