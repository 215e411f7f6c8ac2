// A map, a fuser and what they need, for tests that feed measurements by hand. Header only.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "core/map/fuse.h"
#include "core/map/visible_blocks.h"
#include "tests/reference/map_twin.h"
#include "tests/support/surface_image.h"

namespace hermite::test {

// A frontal plane with a colour, everywhere or nowhere; tests change single pixels.
inline FuseInput frontal_frame(const Camera& camera, float depth_m, float confidence) {
  FuseInput frame{SurfaceImage(frame::intrinsics_of(camera)), {}, {}};
  const std::size_t pixels = frame.surface.size();
  frame.raw_depth_m.assign(pixels, depth_m);
  frame.color.assign(pixels, Rgb8{100, 110, 120});
  if (depth_m > 0) {
    frame.surface.depth_m.assign(pixels, depth_m);
    frame.surface.weight.assign(pixels, confidence);
    frame.surface.normals.assign(pixels, Eigen::Vector3d::UnitZ());
  }
  return frame;
}

class MapBench {
 public:
  MapBench(gpu::Device& device, const Camera& camera, const map::MapOptions& options,
           const frame::FrameOptions& frame_options = {})
      : store(device),
        index(device, frame::intrinsics_of(camera)),
        fuser(device, frame::intrinsics_of(camera), options, frame_options),
        options_(options),
        visible_(device, options),
        commands_(device),
        maps_(make_frame_maps(device, camera)) {
    see(frontal_frame(camera, 0, 0));
  }

  // Makes this the present frame without fusing it.
  void see(const FuseInput& frame) { upload_frame(frame); }

  void fuse(const FuseInput& frame, std::uint32_t frame_number,
            const Rigid3& world_from_camera = {},
            map::ColorFusion color = map::ColorFusion::kMean) {
    upload_frame(frame);
    store.reserve(fuser.new_slots_bound());
    set_camera(world_from_camera);
    visible_.list(commands_, store, maps_.camera(), frame_number);
    index.build(commands_, store, maps_.camera(), 0);
    index.describe(commands_, store, maps_.camera());
    fuser.fuse(commands_, maps_, store, index, {frame_number, color, submap});
    commands_.submit_and_wait();
  }

  // Also brings the counters up to date.
  void clean(std::uint32_t frame_number, const Rigid3& world_from_camera = {}) {
    set_camera(world_from_camera);
    visible_.list(commands_, store, maps_.camera(), frame_number);
    index.build(commands_, store, maps_.camera(), options_.stable_confidence);
    fuser.clean(commands_, maps_, store, index, {frame_number, map::ColorFusion::kMean, submap});
    commands_.submit_and_wait();
  }

  // Builds the index map of these submaps alone.
  void look(const map::SubmapSet& submaps, const Rigid3& world_from_camera) {
    store.set_camera(world_from_camera, submaps);
    visible_.list(commands_, store, maps_.camera(), 0);
    index.build(commands_, store, maps_.camera(), 0);
    commands_.submit_and_wait();
  }

  map::SurfelStore store;
  map::IndexMap index;
  map::Fuser fuser;
  std::uint32_t submap = 0;  // of new surfels
  map::SubmapSet seen;       // empty: all

 private:
  void set_camera(const Rigid3& world_from_camera) {
    if (seen.empty())
      store.set_camera(world_from_camera);
    else
      store.set_camera(world_from_camera, seen);
  }

  void upload_frame(const FuseInput& frame) {
    upload(frame.surface, maps_.surface.levels[0]);
    maps_.raw_depth_m.upload(frame.raw_depth_m);
    std::vector<shared::uint> colors;
    for (const Rgb8 c : frame.color)
      colors.push_back(static_cast<shared::uint>(c.r | (c.g << 8) | (c.b << 16)));
    maps_.color.upload(colors);
  }

  const map::MapOptions options_;
  map::VisibleBlocks visible_;
  gpu::Commands commands_;
  frame::FrameMaps maps_;
};

// Slots that are free by what they hold; the store's own list must be the same.
inline std::vector<std::uint32_t> empty_slots(const std::vector<map::Surfel>& surfels) {
  std::vector<std::uint32_t> empty;
  for (std::uint32_t slot = 0; slot < surfels.size(); ++slot)
    if (surfels[slot].confidence <= 0) empty.push_back(slot);
  return empty;
}

// The counters are right, and every listed slot is free and listed once.
inline void expect_consistent(const map::SurfelStore& store) {
  const std::vector<std::uint32_t> empty = empty_slots(store.download());
  EXPECT_EQ(store.alive_count(), store.slot_count() - empty.size());
  EXPECT_EQ(store.state.mapped()[0].new_count + store.state.mapped()[0].fresh_count, 0u);
  std::vector<std::uint32_t> listed;
  for (const std::vector<std::uint32_t>& zone : free_slots_by_zone(store))
    listed.insert(listed.end(), zone.begin(), zone.end());
  EXPECT_EQ(listed.size(), free_slots(store).size());
  std::sort(listed.begin(), listed.end());
  EXPECT_TRUE(std::adjacent_find(listed.begin(), listed.end()) == listed.end());
  EXPECT_TRUE(std::includes(empty.begin(), empty.end(), listed.begin(), listed.end()));
}

}  // namespace hermite::test
