// The numbers of a map's blocks: each block gets one for good, in the order in which blocks come
// into being, and keeps it when it moves between the device and the host.
// One thread at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/map/surfel_block.h"

namespace hermite::map {

class BlockNumbers {
 public:
  // Returns the name of the block at this place on the device. Blocks after those that have been
  // placed are new, and get the next numbers in their order.
  BlockName name_of(std::uint32_t place) const;

  // The new ones among the first `count` blocks on the device keep these numbers for good. Call it
  // before blocks are placed anew.
  void fix(std::uint32_t count);

  // Returns the number of another new block.
  std::uint32_t next() { return next_number_++; }

  // From now on, the device has these blocks in this order.
  void place(std::span<const SurfelBlock> blocks);

  // This block exists no more, because its surfels were moved before `frame_number`.
  void retire(std::uint32_t number, std::uint32_t frame_number) {
    gone_blocks_.push_back({number, frame_number});
  }
  const std::vector<BlockName>& gone_blocks() const { return gone_blocks_; }

  void save(ByteWriter& bytes) const;
  // Needs a new object, and a check() afterwards.
  void restore(ByteReader& bytes);
  // Fails the reader unless each number occurs once among the blocks on the device, those elsewhere
  // and the ones that are gone.
  void check(ByteReader& bytes, std::size_t blocks_on_device,
             std::span<const std::uint32_t> elsewhere) const;

 private:
  std::vector<BlockName> names_;  // by place on the device
  std::uint32_t next_number_ = 0;
  std::vector<BlockName> gone_blocks_;
};

}  // namespace hermite::map
