// Which submaps are on the device, within the memory that the map may take: those that a frame
// needs, with room for what it may add. Others are moved to the host.
//
// One thread at a time, the device's.
#pragma once

#include <cstdint>

#include "core/adjust/mapping.h"
#include "core/base/byte_stream.h"
#include "core/map/surfel_store.h"

namespace hermite::pipeline {

// Returns for how many surfels the allowed memory (map.gpu_memory_mb) has room, besides all that is
// allocated by now. Throws SetupError if that is too little for a camera whose frame may add
// `most_new` surfels.
std::uint32_t most_slots(const gpu::Device& device, std::int64_t gpu_memory_mb,
                         std::uint32_t most_new);

class MapMemory {
 public:
  // Keeps a reference to the store. A frame may add `most_new` surfels.
  MapMemory(map::SurfelStore& store, std::uint32_t most_new) : store_(store), most_new_(most_new) {}

  // Ensures that these submaps are on the device with room for another frame, by moving others to
  // the host. Returns false if they are too many.
  bool hold(const map::SubmapSet& needed, const adjust::MapLayout& layout);

  // Ensures that the active submaps are on the device, with memory for the surfels that the frame
  // of this number may add to the current one. Returns false if the map is full.
  bool make_room(const adjust::MapLayout& layout, std::uint32_t frame_number);

  std::uint32_t submap() const { return submap_; }  // of the latest new surfels

  // restore() follows that of the store.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  bool try_to_make_room(const adjust::MapLayout& layout, std::uint32_t frame_number);

  map::SurfelStore& store_;
  const std::uint32_t most_new_;
  std::uint32_t submap_ = 0;
  std::uint32_t full_until_frame_ = 0;  // frame number before which no memory is requested again
};

}  // namespace hermite::pipeline
