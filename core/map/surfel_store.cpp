#include "core/map/surfel_store.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <span>
#include <string>

#include "core/base/check.h"

namespace hermite {

namespace {

constexpr std::uint32_t kFirstCapacity = 1u << 19;

// Takes every point to z = -1 m, where no pass sees it.
constexpr shared::Transform kBehindTheCamera{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, -1}};

float half_to_float(std::uint32_t half) {
  return static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(static_cast<std::uint16_t>(half)));
}
std::uint32_t float_to_half(float value) { return Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(value)); }

// The octahedral code of shaders/lib/geometry.glsl.
Eigen::Vector3f unpack_unit(std::uint32_t packed) {
  const auto snorm = [](std::uint32_t bits) {
    return std::clamp(static_cast<float>(static_cast<std::int16_t>(bits & 0xffffu)) / 32767.0f, -1.0f, 1.0f);
  };
  const float x = snorm(packed), y = snorm(packed >> 16);
  Eigen::Vector3f n(x, y, 1.0f - std::abs(x) - std::abs(y));
  if (n.z() < 0) {
    n.x() = (1.0f - std::abs(y)) * (x >= 0 ? 1.0f : -1.0f);
    n.y() = (1.0f - std::abs(x)) * (y >= 0 ? 1.0f : -1.0f);
  }
  return n.normalized();
}

std::uint32_t pack_unit(const Eigen::Vector3f& n) {
  const auto snorm = [](float value) {
    return static_cast<std::uint32_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 32767.0f)) & 0xffffu;
  };
  const auto sign = [](float value) { return value >= 0 ? 1.0f : -1.0f; };
  Eigen::Vector2f p = n.head<2>() / n.lpNorm<1>();
  if (n.z() < 0) p = Eigen::Vector2f((1 - std::abs(p.y())) * sign(p.x()), (1 - std::abs(p.x())) * sign(p.y()));
  return snorm(p.x()) | (snorm(p.y()) << 16);
}

// As shaders/lib/blocks.glsl orders numbers.
std::uint32_t ordered(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

shared::SurfelAttributes pack_attributes(const Surfel& s) {
  return {pack_unit(s.normal_in_submap), float_to_half(s.radius_m) | (s.submap << 16),
          s.r | (std::uint32_t{s.g} << 8) | (std::uint32_t{s.b} << 16),
          float_to_half(s.curvature_max_per_m) | (float_to_half(s.curvature_min_per_m) << 16)};
}

Surfel unpack(const shared::vec4& p, const shared::SurfelAttributes& a, const shared::uvec2& t) {
  Surfel s;
  s.position_in_submap_m = {p.x, p.y, p.z};
  s.normal_in_submap = unpack_unit(a.normal);
  s.radius_m = half_to_float(a.radius_submap & 0xffffu);
  s.confidence = p.w;
  s.curvature_max_per_m = half_to_float(a.curvatures & 0xffffu);
  s.curvature_min_per_m = half_to_float(a.curvatures >> 16);
  s.r = static_cast<std::uint8_t>(a.color & 255u);
  s.g = static_cast<std::uint8_t>((a.color >> 8) & 255u);
  s.b = static_cast<std::uint8_t>((a.color >> 16) & 255u);
  s.submap = a.radius_submap >> 16;
  s.created_frame = t.x;
  s.observed_frame = t.y;
  return s;
}

// A larger buffer with the old content in front.
template <class T>
void grow(gpu::Device& device, gpu::Buffer<T>& buffer, std::size_t count) {
  gpu::Buffer<T> larger(device, count, "map");
  if (buffer.count() > 0) {
    gpu::Commands commands(device);
    commands.copy(buffer, larger, buffer.bytes());
    commands.submit_and_wait();
  }
  buffer = std::move(larger);
}

}  // namespace

shared::Transform to_shared(const Rigid3& target_from_source) {
  const Eigen::Matrix<float, 3, 4> m = target_from_source.matrix().topRows<3>().cast<float>();
  const auto row = [&m](int i) { return shared::vec4{m(i, 0), m(i, 1), m(i, 2), m(i, 3)}; };
  return {row(0), row(1), row(2)};
}

std::vector<shared::BlockBounds> bounds_of(std::span<const Surfel> surfels) {
  std::vector<shared::BlockBounds> bounds((surfels.size() + kSlotsPerBlock - 1) / kSlotsPerBlock);
  for (std::size_t slot = 0; slot < surfels.size(); ++slot) {
    const Surfel& s = surfels[slot];
    if (s.confidence <= 0) continue;
    const Eigen::Vector3f& p = s.position_in_submap_m;
    const auto submap = static_cast<float>(s.submap);
    const float reach[8] = {p.x(), p.y(), p.z(), -p.x(), -p.y(), -p.z(), submap, -submap};
    for (int i = 0; i < 8; ++i) {
      std::uint32_t& farthest = bounds[slot / kSlotsPerBlock].reach[i];
      farthest = std::max(farthest, ordered(reach[i]));
    }
  }
  return bounds;
}

SurfelStore::SurfelStore(gpu::Device& device, std::uint32_t max_slots)
    : state(device, 1, "map", gpu::Memory::kReadback),
      camera_from_submap(device, 1, "map"),
      device_(device),
      max_slots_(std::min(max_slots, kMaxSlots) / kSlotsPerBlock * kSlotsPerBlock),
      world_from_submap_(1) {
  reserve(std::min(kFirstCapacity, max_slots_));
}

void SurfelStore::reserve(std::uint32_t additional) {
  if (!has_room_for(additional))
    throw gpu::DeviceError("the map is full: it has " + std::to_string(slot_count()) + " surfels on the device, at most " +
                           std::to_string(max_slots_) + " fit");
  const std::uint32_t wanted = slot_count() + additional;
  if (wanted <= capacity_) return;
  const std::uint32_t block_count =
      (std::min(std::max(wanted, capacity_ + capacity_ / 2), max_slots_) + kSlotsPerBlock - 1) / kSlotsPerBlock;
  const std::uint32_t capacity = block_count * kSlotsPerBlock;  // whole blocks, so that a pass may look at all slots of one
  grow(device_, positions, capacity);
  grow(device_, attributes, capacity);
  grow(device_, times, capacity);
  grow(device_, free_slots, capacity);
  grow(device_, bounds, block_count);
  grow(device_, changed_frames, block_count);
  group_counts = gpu::Buffer<shared::uint>(device_, block_count, "map");
  visible_blocks = gpu::Buffer<shared::uint>(device_, 6 + block_count, "map");
  capacity_ = capacity;
}

void SurfelStore::set_submaps(std::span<const Rigid3> world_from_submap) {
  CHECK(world_from_submap.size() >= world_from_submap_.size() && world_from_submap.size() <= kMaxSubmaps, "submaps do not go, or too many");
  world_from_submap_.assign(world_from_submap.begin(), world_from_submap.end());
  if (camera_from_submap.count() < world_from_submap_.size())
    camera_from_submap = gpu::Buffer<shared::Transform>(device_, std::bit_ceil(world_from_submap_.size()), "map");
}

void SurfelStore::set_camera(const Rigid3& world_from_camera) { set_camera(world_from_camera, SubmapSet(world_from_submap_.size(), true)); }

void SurfelStore::set_camera(const Rigid3& world_from_camera, const SubmapSet& seen) {
  CHECK(seen.size() == world_from_submap_.size(), "a set of other submaps");
  const Rigid3 camera_from_world = inverse(world_from_camera);
  std::vector<shared::Transform> transforms;
  for (std::size_t submap = 0; submap < seen.size(); ++submap)
    transforms.push_back(seen[submap] ? to_shared(camera_from_world * world_from_submap_[submap]) : kBehindTheCamera);
  camera_from_submap.upload(transforms);
}

void SurfelStore::begin_block() {
  shared::MapState after = counters();
  after.slot_count = (after.slot_count + kSlotsPerBlock - 1) / kSlotsPerBlock * kSlotsPerBlock;
  after.free_count = 0;
  for (shared::ZoneSlots& zone : after.zones) zone.free_count = 0;
  state.upload(std::vector<shared::MapState>{after});
}

void SurfelStore::append(std::span<const Surfel> surfels) {
  const std::uint32_t first_block = (slot_count() + kSlotsPerBlock - 1) / kSlotsPerBlock, first = first_block * kSlotsPerBlock;
  if (surfels.size() > max_slots_) throw gpu::DeviceError("the map has no room for " + std::to_string(surfels.size()) + " surfels");
  reserve(first - slot_count() + static_cast<std::uint32_t>(surfels.size()));
  std::vector<shared::vec4> new_positions;
  std::vector<shared::SurfelAttributes> new_attributes;
  std::vector<shared::uvec2> new_times;
  for (const Surfel& s : surfels) {
    new_positions.push_back({s.position_in_submap_m.x(), s.position_in_submap_m.y(), s.position_in_submap_m.z(), s.confidence});
    new_attributes.push_back(pack_attributes(s));
    new_times.push_back({s.created_frame, s.observed_frame});
  }
  positions.upload(new_positions, first);
  attributes.upload(new_attributes, first);
  times.upload(new_times, first);
  const std::vector<shared::BlockBounds> new_bounds = bounds_of(surfels);
  bounds.upload(new_bounds, first_block);
  std::vector<shared::uint> changed(new_bounds.size(), 0);
  for (std::size_t i = 0; i < surfels.size(); ++i)
    changed[i / kSlotsPerBlock] = std::max(changed[i / kSlotsPerBlock], surfels[i].observed_frame);
  changed_frames.upload(changed, first_block);
  shared::MapState after = counters();
  after.slot_count = first + static_cast<std::uint32_t>(surfels.size());
  after.alive_count += static_cast<std::uint32_t>(surfels.size());
  state.upload(std::vector<shared::MapState>{after});
}

std::vector<Surfel> SurfelStore::download() const {
  const std::vector<shared::vec4> p = positions.download(slot_count());
  const std::vector<shared::SurfelAttributes> a = attributes.download(slot_count());
  const std::vector<shared::uvec2> t = times.download(slot_count());
  std::vector<Surfel> surfels(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) surfels[i] = unpack(p[i], a[i], t[i]);
  return surfels;
}

std::uint32_t SurfelStore::number_of(std::uint32_t block) const {
  return block < numbers_.size() ? numbers_[block] : next_number_ + block - static_cast<std::uint32_t>(numbers_.size());
}

// Behind those in `blocks`. One transfer an array, however many blocks: each costs a round trip to a device with memory of its own.
void SurfelStore::download_blocks(std::uint32_t first, std::uint32_t count, std::vector<Block>& blocks) const {
  const std::size_t slots = std::size_t{count} * kSlotsPerBlock, first_slot = std::size_t{first} * kSlotsPerBlock;
  const std::vector<shared::vec4> p = positions.download(slots, first_slot);
  const std::vector<shared::SurfelAttributes> a = attributes.download(slots, first_slot);
  const std::vector<shared::uvec2> t = times.download(slots, first_slot);
  const std::vector<shared::BlockBounds> b = bounds.download(count, first);
  const std::vector<shared::uint> changed = changed_frames.download(count, first);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(std::size_t{i} * kSlotsPerBlock),
               end = begin + static_cast<std::ptrdiff_t>(kSlotsPerBlock);
    Block block{number_of(first + i),
                {p.begin() + begin, p.begin() + end},
                {a.begin() + begin, a.begin() + end},
                {t.begin() + begin, t.begin() + end},
                b[i],
                changed[i]};
    describe(block);
    blocks.push_back(std::move(block));
  }
}

// From the first on.
void SurfelStore::upload_blocks(std::span<const Block> blocks) {
  std::vector<shared::vec4> p;
  std::vector<shared::SurfelAttributes> a;
  std::vector<shared::uvec2> t;
  std::vector<shared::BlockBounds> b;
  std::vector<shared::uint> changed;
  for (const Block& block : blocks) {
    p.insert(p.end(), block.positions.begin(), block.positions.end());
    a.insert(a.end(), block.attributes.begin(), block.attributes.end());
    t.insert(t.end(), block.times.begin(), block.times.end());
    b.push_back(block.bounds);
    changed.push_back(block.changed_frame);
  }
  positions.upload(p);
  attributes.upload(a);
  times.upload(t);
  bounds.upload(b);
  changed_frames.upload(changed);
}

void SurfelStore::clear_blocks(std::uint32_t first, std::uint32_t count) {
  const std::size_t slots = std::size_t{count} * kSlotsPerBlock, first_slot = std::size_t{first} * kSlotsPerBlock;
  positions.upload(std::vector<shared::vec4>(slots), first_slot);
  attributes.upload(std::vector<shared::SurfelAttributes>(slots), first_slot);
  times.upload(std::vector<shared::uvec2>(slots), first_slot);
  bounds.upload(std::vector<shared::BlockBounds>(count), first);
  changed_frames.upload(std::vector<shared::uint>(count), first);
}

void SurfelStore::keep(const SubmapSet& submaps) {
  const std::uint32_t count_before = block_count();
  std::vector<Block> all, kept;
  download_blocks(0, count_before, all);
  std::map<std::uint32_t, std::vector<Block>> leaving;
  for (Block& block : all) {
    const bool stays = block.alive_count == 0 || submaps[block.submap];  // what has died in an empty one may still have to be told
    (stays ? kept : leaving[block.submap]).push_back(std::move(block));
  }
  for (auto& [submap, blocks] : host_blocks_)
    if (submaps[submap]) std::move(blocks.begin(), blocks.end(), std::back_inserter(kept));
  std::erase_if(host_blocks_, [&](const auto& entry) { return submaps[entry.first]; });
  for (auto& [submap, blocks] : leaving) std::move(blocks.begin(), blocks.end(), std::back_inserter(host_blocks_[submap]));

  next_number_ += count_before - static_cast<std::uint32_t>(numbers_.size());
  shared::MapState after{};
  state.upload(std::vector{after});  // empty, so that there is room for what comes
  const auto count = static_cast<std::uint32_t>(kept.size());
  reserve(count * kSlotsPerBlock);
  upload_blocks(kept);
  if (count < count_before) clear_blocks(count, count_before - count);
  numbers_.clear();
  for (const Block& block : kept) {
    numbers_.push_back(block.number);
    after.alive_count += block.alive_count;
  }
  after.slot_count = count * kSlotsPerBlock;
  state.upload(std::vector{after});
}

std::vector<NumberedSurfel> SurfelStore::changed_blocks(std::uint32_t since) const {
  std::vector<Block> changed;
  const std::vector<shared::uint> frames = changed_frames.download(block_count());
  const auto has_changed = [since](std::uint32_t frame) { return frame > since; };
  for (auto begin = std::find_if(frames.begin(), frames.end(), has_changed); begin != frames.end();) {
    const auto end = std::find_if_not(begin, frames.end(), has_changed);
    download_blocks(static_cast<std::uint32_t>(begin - frames.begin()), static_cast<std::uint32_t>(end - begin), changed);
    begin = std::find_if(end, frames.end(), has_changed);
  }
  for (const auto& [submap, blocks] : host_blocks_)
    for (const Block& block : blocks)
      if (block.changed_frame > since) changed.push_back(block);
  std::sort(changed.begin(), changed.end(), [](const Block& a, const Block& b) { return a.number < b.number; });
  std::vector<NumberedSurfel> surfels;
  surfels.reserve(changed.size() * kSlotsPerBlock);
  for (const Block& block : changed)
    for (std::uint32_t i = 0; i < kSlotsPerBlock; ++i)
      surfels.push_back({block.number * kSlotsPerBlock + i, unpack(block.positions[i], block.attributes[i], block.times[i])});
  return surfels;
}

std::int64_t SurfelStore::surfel_count() const {
  std::int64_t count = alive_count();
  for (const auto& [submap, blocks] : host_blocks_)
    for (const Block& block : blocks) count += block.alive_count;
  return count;
}

std::int64_t SurfelStore::host_bytes() const {
  constexpr std::size_t kBytesPerBlock =
      kSlotsPerBlock * (sizeof(shared::vec4) + sizeof(shared::SurfelAttributes) + sizeof(shared::uvec2)) + sizeof(Block);
  std::size_t blocks_count = 0;
  for (const auto& [submap, blocks] : host_blocks_) blocks_count += blocks.size();
  return static_cast<std::int64_t>(blocks_count * kBytesPerBlock);
}

}  // namespace hermite
