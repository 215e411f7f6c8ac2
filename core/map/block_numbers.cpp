#include "core/map/block_numbers.h"

#include <algorithm>

namespace hermite::map {

namespace {

// The number of blocks with all slots that a scan's changes can address (core/output/chunks.h).
constexpr std::uint32_t kMaxBlockNumber = 1u << 20;

}  // namespace

BlockName BlockNumbers::name_of(std::uint32_t place) const {
  return place < names_.size()
             ? names_[place]
             : BlockName{next_number_ + place - static_cast<std::uint32_t>(names_.size())};
}

void BlockNumbers::fix(std::uint32_t count) {
  while (names_.size() < count) names_.push_back({next()});
}

void BlockNumbers::place(std::span<const SurfelBlock> blocks) {
  names_.clear();
  for (const SurfelBlock& block : blocks) names_.push_back(block.name);
}

void BlockNumbers::save(ByteWriter& bytes) const {
  bytes.numbers(names_);
  bytes.number(next_number_);
  bytes.numbers(gone_blocks_);
}

void BlockNumbers::restore(ByteReader& bytes) {
  bytes.numbers(names_);
  bytes.number(next_number_);
  bytes.numbers(gone_blocks_);
}

void BlockNumbers::check(ByteReader& bytes, std::size_t blocks_on_device,
                         std::span<const std::uint32_t> elsewhere) const {
  bytes.require(names_.size() <= blocks_on_device &&
                    next_number_ <=
                        kMaxBlockNumber - std::min<std::size_t>(blocks_on_device, kMaxBlockNumber),
                "the block numbers are out of range");
  if (!bytes.ok()) return;
  std::vector<bool> is_taken(next_number_, false);
  const auto take = [&](std::uint32_t number) {
    const bool right = number < next_number_ && !is_taken[number];
    bytes.require(right, "a block number is out of range or occurs twice");
    if (right) is_taken[number] = true;
  };
  for (const BlockName& name : names_) take(name.number);
  for (const std::uint32_t number : elsewhere) take(number);
  for (const BlockName& gone : gone_blocks_) take(gone.number);
}

}  // namespace hermite::map
