// Which surfel is nearest in every pixel of a view. Built by two passes of integer minima: deterministic.
#pragma once

#include "core/gpu/kernel.h"
#include "core/map/surfel_store.h"

namespace hermite {

// Beyond this a surfel covers less than a pixel of any supported camera.
inline constexpr float kFarthest_m = 20.0f;

inline constexpr shared::uint kNoSurfel = 0xffffffffu;

class IndexMap {
 public:
  // `camera` has the size of all views.
  IndexMap(gpu::Device& device, const shared::Intrinsics& camera);

  // Records the passes: surfels of at least `min_confidence` (and alive), as seen by the camera that the store was set to, 5 cm to
  // kFarthest_m away. The store's visible blocks must have been listed for this view.
  void build(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera, double min_confidence);

  // Records: what association asks of the surfels shown. After build(), with the same camera.
  void describe(gpu::Commands& commands, const SurfelStore& store, const shared::Intrinsics& camera);

  // By pixel: the depth of that surfel as the bits of a float.
  const gpu::Buffer<shared::uint>& depth_bits() const { return depth_bits_; }
  const gpu::Buffer<shared::uint>& slots() const { return ids_; }         // by pixel, kNoSurfel where there is none
  const gpu::Buffer<shared::IndexCell>& cells() const { return cells_; }  // by pixel, after describe()

 private:
  gpu::Kernel depth_kernel_, id_kernel_, surfel_kernel_;
  gpu::Buffer<shared::uint> depth_bits_, ids_;
  gpu::Buffer<shared::IndexCell> cells_;
};

}  // namespace hermite
