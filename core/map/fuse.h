// Fusion of a frame into the map, and cleaning (paper section 5; core/METHOD.md).
#pragma once

#include "core/frame/brightness.h"
#include "core/frame/preprocess.h"
#include "core/map/index_map.h"
#include "core/map/map_options.h"

namespace hermite::map {

// What becomes of the colours of surfels that a frame shows: they keep them, get the mean, or take
// those of the frame. The values are those of shared::FuseParams::color_use.
enum class ColorFusion : std::uint32_t { kKeep, kMean, kReplace };

struct FusedFrame {
  std::uint32_t number = 0;  // index among the fused frames, from 1
  ColorFusion color = ColorFusion::kMean;
  std::uint32_t submap = 0;  // the submap of new surfels
  bool add_new = true;       // false: only existing surfels are updated
  // Brightness of the frame relative to the map, which keeps its own brightness.
  frame::Brightness brightness{};
};

class Fuser {
 public:
  // `camera` has the size of all frames.
  Fuser(gpu::Device& device, const shared::Intrinsics& camera, const MapOptions& options,
        const frame::FrameOptions& frame_options);

  // Records the fusion of the frame's pixels into the surfels of `all`, an index map of every
  // surfel after describe(); pixels without a match are appended as new surfels. The store must be
  // set to the frame's pose and, if surfels are added, have room for new_slots_bound() more.
  void fuse(gpu::Commands& commands, const frame::FrameMaps& frame, SurfelStore& store,
            const IndexMap& all, FusedFrame fused);

  // Records the cleaning of the store's visible blocks: contradicted surfels and those unstable for
  // too long are removed, in the blocks whose turn it is, and free slots are listed. `stable` is an
  // index map of stable surfels after the fusion of `frame`, at its pose. Updates the store's
  // counters.
  void clean(gpu::Commands& commands, const frame::FrameMaps& frame, SurfelStore& store,
             const IndexMap& stable, FusedFrame fused);

  // Returns the largest number of slots that one frame can add.
  std::uint32_t new_slots_bound() const { return static_cast<std::uint32_t>(candidates_.count()); }

 private:
  shared::FuseParams params_of(const shared::Intrinsics& camera, const SurfelStore& store,
                               const FusedFrame& fused) const;

  const MapOptions options_;
  const double curvature_limit_per_m_, radius_scale_;
  gpu::Kernel associate_, merge_, scan_, list_new_, append_, index_times_, clean_, count_free_,
      free_list_;
  gpu::Buffer<shared::uint> candidates_;  // per pixel
  gpu::Buffer<shared::uint> claims_;      // per pixel of the index map; then the list of new pixels
  gpu::Buffer<shared::uvec4> seen_;       // per pixel of the index map of stable surfels
  gpu::Buffer<shared::uint> new_by_tile_;
  gpu::Buffer<shared::uint> new_bits_;  // by tile, one bit per pixel
};

}  // namespace hermite::map
