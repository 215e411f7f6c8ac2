// The nearest surfel in every pixel of a view. It is built by integer minima, so the order of
// execution does not matter: in one pass if the device has 64-bit atomics, else in two, with the
// same result.
#pragma once

#include <vector>

#include "core/gpu/kernel.h"
#include "core/map/surfel_store.h"

namespace hermite::map {

// Farther away, a surfel covers less than a pixel of every supported camera.
inline constexpr float kFarthest_m = 20.0f;

inline constexpr shared::uint kNoSurfel = HERMITE_NONE;

class IndexMap {
 public:
  // `camera` has the size of all views. `passes` may only be 1 if the device has 64-bit atomics.
  IndexMap(gpu::Device& device, const shared::Intrinsics& camera, int passes);
  IndexMap(gpu::Device& device, const shared::Intrinsics& camera);

  // Records the passes for live surfels of at least `min_confidence`, from 5 cm to kFarthest_m
  // away, as seen by the camera that the store was set to. The store's visible blocks must have
  // been listed for this view.
  void build(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera,
             double min_confidence);

  // Records the attributes of the nearest surfels that association needs. Call it after build(),
  // with the same camera.
  void describe(gpu::Commands& commands, const SurfelStore& store,
                const shared::Intrinsics& camera);

  // One entry per pixel.
  const gpu::Buffer<shared::NearestSurfel>& nearest() const { return nearest_; }
  const gpu::Buffer<shared::IndexCell>& cells() const { return cells_; }  // after describe()

 private:
  std::vector<gpu::Kernel> passes_;
  gpu::Kernel surfel_kernel_;
  gpu::Buffer<shared::NearestSurfel> nearest_;
  gpu::Buffer<shared::IndexCell> cells_;
};

}  // namespace hermite::map
