// Blocks of surfels that wait in host memory, by the submap that they belong to.
// One thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/map/surfel_block.h"

namespace hermite::map {

// Membership by submap.
using SubmapSet = std::vector<bool>;

class HostBlocks {
 public:
  bool has(std::uint32_t submap) const { return by_submap_.contains(submap); }
  void add(SurfelBlock block);

  // Moves the blocks of these submaps to the end of `blocks`.
  void take(const SubmapSet& submaps, std::vector<SurfelBlock>& blocks);
  // Returns how many blocks that would be.
  std::size_t count_of(const SubmapSet& submaps) const;

  // Copies the blocks that changed after frame `since` to the end of `blocks`.
  void copy_changed(std::uint32_t since, std::vector<SurfelBlock>& blocks) const;

  std::int64_t alive_count() const;
  std::int64_t bytes() const;
  std::vector<std::uint32_t> numbers() const;

  // restore() needs an empty object; after a failure of the reader it must not be used.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes, std::size_t submap_count);

 private:
  std::map<std::uint32_t, std::vector<SurfelBlock>> by_submap_;
};

}  // namespace hermite::map
