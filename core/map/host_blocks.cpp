#include "core/map/host_blocks.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace hermite::map {

void HostBlocks::add(SurfelBlock block) {
  std::vector<SurfelBlock>& blocks = by_submap_[block.submap];
  blocks.push_back(std::move(block));
}

void HostBlocks::take(const SubmapSet& submaps, std::vector<SurfelBlock>& blocks) {
  for (auto& [submap, here] : by_submap_)
    if (submaps[submap]) std::move(here.begin(), here.end(), std::back_inserter(blocks));
  std::erase_if(by_submap_, [&](const auto& entry) { return submaps[entry.first]; });
}

std::size_t HostBlocks::count_of(const SubmapSet& submaps) const {
  std::size_t count = 0;
  for (const auto& [submap, blocks] : by_submap_) count += submaps[submap] ? blocks.size() : 0;
  return count;
}

void HostBlocks::copy_changed(std::uint32_t since, std::vector<SurfelBlock>& blocks) const {
  for (const auto& [submap, here] : by_submap_)
    for (const SurfelBlock& block : here)
      if (block.changed_frame > since) blocks.push_back(block);
}

std::int64_t HostBlocks::alive_count() const {
  std::int64_t count = 0;
  for (const auto& [submap, blocks] : by_submap_)
    for (const SurfelBlock& block : blocks) count += block.alive_count;
  return count;
}

std::int64_t HostBlocks::bytes() const {
  constexpr std::size_t kBytesPerBlock =
      kSlotsPerBlock *
          (sizeof(shared::vec4) + sizeof(shared::SurfelAttributes) + sizeof(shared::uvec2)) +
      sizeof(SurfelBlock);
  return static_cast<std::int64_t>(numbers().size() * kBytesPerBlock);
}

std::vector<std::uint32_t> HostBlocks::numbers() const {
  std::vector<std::uint32_t> numbers;
  for (const auto& [submap, blocks] : by_submap_)
    for (const SurfelBlock& block : blocks) numbers.push_back(block.name.number);
  return numbers;
}

void HostBlocks::save(ByteWriter& bytes) const {
  bytes.number(static_cast<std::uint32_t>(by_submap_.size()));
  for (const auto& [submap, blocks] : by_submap_) {
    bytes.number(submap);
    bytes.list(blocks, [](ByteWriter& to, const SurfelBlock& block) { map::save(to, block); });
  }
}

void HostBlocks::restore(ByteReader& bytes, std::size_t submap_count) {
  std::uint32_t left = 0;
  bytes.number(left);
  for (; left > 0 && bytes.ok(); --left) {
    std::uint32_t submap = 0;
    bytes.number(submap);
    bytes.require(submap < submap_count && !has(submap),
                  "the submap of host blocks is out of range or occurs twice");
    bytes.list(by_submap_[submap], [submap_count](ByteReader& from, SurfelBlock& block) {
      map::restore(from, block, submap_count);
    });
  }
}

}  // namespace hermite::map
