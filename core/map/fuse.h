// Fusion of a frame into the map, and cleaning (paper section 5; core/METHOD.md).
#pragma once

#include "core/frame/brightness.h"
#include "core/frame/preprocess.h"
#include "core/map/index_map.h"
#include "core/map/map_options.h"

namespace hermite {

struct FusedFrame {
  std::uint32_t number = 0;  // of the frames fused, the first is 1
  bool with_color = true;    // surfels that exist take on its colours
  std::uint32_t submap = 0;  // new surfels belong to it
  bool add_new = true;       // no: only surfels that exist are continued
  Brightness brightness{};   // of the frame; the map keeps its own
};

class Fuser {
 public:
  // `camera` has the size of all frames.
  Fuser(gpu::Device& device, const shared::Intrinsics& camera, const MapOptions& options, const FrameOptions& frame_options);

  // Records: the frame's pixels are merged into the surfels of `all`, a described index map of every surfel, or appended. The store must be
  // set to the frame's pose and, if new ones are added, have room for new_slots_bound() more.
  void fuse(gpu::Commands& commands, const FrameMaps& frame, SurfelStore& store, const IndexMap& all, FusedFrame fused);

  // Records: contradicted and forgotten surfels among those in turn are removed and free slots listed, in the store's visible blocks.
  // `stable` is an index map of stable surfels after fusing `frame`, seen from where it was. Brings the store's counters up to date.
  void clean(gpu::Commands& commands, const FrameMaps& frame, SurfelStore& store, const IndexMap& stable, FusedFrame fused);

  // Slots that one frame can add at most.
  std::uint32_t new_slots_bound() const { return static_cast<std::uint32_t>(candidates_.count()); }

 private:
  shared::FuseParams params_of(const shared::Intrinsics& camera, const SurfelStore& store, const FusedFrame& fused) const;

  const MapOptions options_;
  const double curvature_limit_per_m_, radius_scale_;
  gpu::Kernel associate_, merge_, scan_, append_, index_times_, clean_, count_free_, free_list_;
  gpu::Buffer<shared::uint> candidates_;  // by pixel
  gpu::Buffer<shared::uint> claims_;      // by pixel of the index map
  gpu::Buffer<shared::uvec4> seen_;       // by pixel of the index map of stable surfels
  gpu::Buffer<shared::uint> new_by_tile_;
};

}  // namespace hermite
