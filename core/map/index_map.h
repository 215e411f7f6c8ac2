// Which surfel is nearest in every pixel of a view. Built by integer minima, whose order changes nothing: in one pass where the device has
// 64-bit atomics, else in two, to the same map.
#pragma once

#include <vector>

#include "core/gpu/kernel.h"
#include "core/map/surfel_store.h"

namespace hermite {

// Beyond this a surfel covers less than a pixel of any supported camera.
inline constexpr float kFarthest_m = 20.0f;

inline constexpr shared::uint kNoSurfel = HERMITE_NONE;

class IndexMap {
 public:
  // `camera` has the size of all views. `passes`: 1 only where the device has 64-bit atomics.
  IndexMap(gpu::Device& device, const shared::Intrinsics& camera, int passes);
  IndexMap(gpu::Device& device, const shared::Intrinsics& camera);

  // Records the passes: surfels of at least `min_confidence` (and alive), as seen by the camera that the store was set to, 5 cm to
  // kFarthest_m away. The store's visible blocks must have been listed for this view.
  void build(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera, double min_confidence);

  // Records: what association asks of the surfels shown. After build(), with the same camera.
  void describe(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera);

  // By pixel.
  const gpu::Buffer<shared::NearestSurfel>& nearest() const { return nearest_; }
  const gpu::Buffer<shared::IndexCell>& cells() const { return cells_; }  // after describe()

 private:
  std::vector<gpu::Kernel> passes_;
  gpu::Kernel surfel_kernel_;
  gpu::Buffer<shared::NearestSurfel> nearest_;
  gpu::Buffer<shared::IndexCell> cells_;
};

}  // namespace hermite
