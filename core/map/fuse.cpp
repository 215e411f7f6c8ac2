#include "core/map/fuse.h"

#include <cmath>
#include <cstddef>

namespace hermite::map {

namespace {

// A workgroup processes a tile of the image, with a bit for each pixel.
constexpr std::uint32_t kTileSide = HERMITE_TILE_SIDE;
constexpr std::uint32_t kPixelsOfTile = kTileSide * kTileSide, kWordsOfTile = kPixelsOfTile / 32;
std::uint32_t tile_count(const shared::Intrinsics& camera) {
  return ((camera.width + kTileSide - 1) / kTileSide) *
         ((camera.height + kTileSide - 1) / kTileSide);
}

}  // namespace

Fuser::Fuser(gpu::Device& device, const shared::Intrinsics& camera, const MapOptions& options,
             const frame::FrameOptions& frame_options)
    : options_(options),
      curvature_limit_per_m_(frame_options.curvature_limit_per_m),
      radius_scale_(frame_options.support_radius_scale),
      associate_(device, "map/associate"),
      merge_(device, "map/merge"),
      scan_(device, "map/scan"),
      list_new_(device, "map/list_new"),
      append_(device, "map/append"),
      index_times_(device, "map/index_times"),
      clean_(device, "map/clean"),
      count_free_(device, "map/count_free"),
      free_list_(device, "map/free_list"),
      candidates_(device, static_cast<std::size_t>(camera.width) * camera.height, "fusion"),
      claims_(device, static_cast<std::size_t>(camera.width) * camera.height, "fusion"),
      seen_(device, static_cast<std::size_t>(camera.width) * camera.height, "fusion"),
      new_by_tile_(device, tile_count(camera), "fusion"),
      new_bits_(device, std::size_t{kWordsOfTile} * tile_count(camera), "fusion") {}

shared::FuseParams Fuser::params_of(const shared::Intrinsics& camera, const SurfelStore& store,
                                    const FusedFrame& fused) const {
  return {camera,
          fused.number,
          store.capacity(),
          static_cast<float>(options_.fuse_depth_gate_m),
          static_cast<float>(std::cos(options_.fuse_normal_gate_rad)),
          static_cast<float>(options_.max_confidence),
          static_cast<float>(curvature_limit_per_m_),
          fused.submap,
          options_.fuse_surface ? 1u : 0u,
          options_.weigh_by_radius ? 1u : 0u,
          static_cast<float>(radius_scale_),
          static_cast<std::uint32_t>(fused.color),
          static_cast<float>(fused.brightness.gain),
          static_cast<float>(fused.brightness.offset),
          fused.add_new ? 1u : 0u};
}

void Fuser::fuse(gpu::Commands& commands, const frame::FrameMaps& frame, SurfelStore& store,
                 const IndexMap& all, FusedFrame fused) {
  const frame::SurfaceLevel& surface = frame.surface.levels[0];
  const shared::FuseParams params = params_of(surface.camera, store, fused);
  const std::uint32_t tiles = tile_count(surface.camera), threads = kPixelsOfTile * tiles;
  const gpu::BufferRef new_pixels = claims_;  // which merging needs no more
  const gpu::GroupCounts new_groups{store.state,
                                    offsetof(shared::MapState, new_groups) / sizeof(shared::uint)};
  // With the buffers that all passes over the frame's pixels have.
  const auto with_common = [&](const auto& run, const auto&... more) {
    run({{"raw_depth_m", frame.raw_depth_m},
         {"frame_points", surface.points},
         {"frame_color", frame.color},
         {"position_confidence", store.positions},
         {"attributes", store.attributes},
         {"times", store.times},
         {"camera_from_submap", store.camera_from_submap},
         {"candidates", candidates_},
         {"new_by_group", new_by_tile_},
         {"state", store.state},
         more...});
  };
  using gpu::NamedBuffer;
  using Buffers = std::initializer_list<NamedBuffer>;
  const auto dispatch = [&](const gpu::Kernel& kernel, const auto&... more) {
    with_common([&](Buffers buffers) { commands.dispatch(kernel, {threads}, params, buffers); },
                more...);
  };
  commands.fill(claims_, kNoSurfel);
  dispatch(associate_, NamedBuffer{"cells", all.cells()}, NamedBuffer{"claims", claims_});
  dispatch(merge_, NamedBuffer{"cells", all.cells()}, NamedBuffer{"claims", claims_},
           NamedBuffer{"changed_frame", store.changed_frames},
           NamedBuffer{"read_position_confidence", store.positions},
           NamedBuffer{"read_attributes", store.attributes}, NamedBuffer{"new_bits", new_bits_});
  commands.dispatch(
      scan_, {128}, shared::ScanParams{surface.camera, tiles},
      {{"counts", new_by_tile_}, {"state", store.state}, {"visible_blocks", store.visible_blocks}});
  commands.dispatch(
      list_new_, {kWordsOfTile * tiles}, shared::ListNewParams{surface.camera, tiles},
      {{"new_bits", new_bits_}, {"new_by_group", new_by_tile_}, {"new_pixels", new_pixels}});
  with_common(
      [&](Buffers buffers) { commands.dispatch_indirect(append_, new_groups, params, buffers); },
      NamedBuffer{"free_slots", store.free_slots}, NamedBuffer{"bounds", store.bounds},
      NamedBuffer{"changed_frame", store.changed_frames}, NamedBuffer{"new_pixels", new_pixels});
}

void Fuser::clean(gpu::Commands& commands, const frame::FrameMaps& frame, SurfelStore& store,
                  const IndexMap& stable, FusedFrame fused) {
  const shared::Intrinsics camera = frame.camera();
  const shared::FreeListParams listed{fused.number, fused.submap};
  const shared::uint pixels = camera.width * camera.height;
  commands.dispatch(index_times_, {pixels}, pixels,
                    {{"nearest", stable.nearest()}, {"times", store.times}, {"seen", seen_}});
  commands.dispatch_indirect(
      clean_,
      {store.visible_blocks, offsetof(shared::VisibleHead, turn_groups) / sizeof(shared::uint)},
      shared::CleanParams{camera, fused.number, static_cast<float>(options_.stable_confidence),
                          static_cast<shared::uint>(options_.max_unstable_age_frames),
                          static_cast<float>(options_.redundancy_depth_m),
                          static_cast<float>(curvature_limit_per_m_),
                          static_cast<float>(options_.fuse_depth_gate_m)},
      {{"position_confidence", store.positions},
       {"attributes", store.attributes},
       {"times", store.times},
       {"camera_from_submap", store.camera_from_submap},
       {"seen", seen_},
       {"state", store.state},
       {"visible_blocks", store.visible_blocks},
       {"bounds", store.bounds},
       {"read_position_confidence", store.positions},
       {"raw_depth_m", frame.raw_depth_m}});
  commands.dispatch_indirect(count_free_, {store.visible_blocks}, listed,
                             {{"position_confidence", store.positions},
                              {"free_by_group", store.group_counts},
                              {"state", store.state},
                              {"visible_blocks", store.visible_blocks},
                              {"bounds", store.bounds}});
  commands.dispatch(scan_, {128}, shared::ScanParams{camera, 0},
                    {{"counts", store.group_counts},
                     {"state", store.state},
                     {"visible_blocks", store.visible_blocks}});
  commands.dispatch_indirect(free_list_, {store.visible_blocks}, listed,
                             {{"position_confidence", store.positions},
                              {"free_by_group", store.group_counts},
                              {"state", store.state},
                              {"free_slots", store.free_slots},
                              {"times", store.times},
                              {"visible_blocks", store.visible_blocks},
                              {"bounds", store.bounds},
                              {"changed_frame", store.changed_frames},
                              {"read_position_confidence", store.positions}});
}

}  // namespace hermite::map
