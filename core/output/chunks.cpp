#include "core/output/chunks.h"

#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud_builder.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>

namespace hermite::output {
namespace {

constexpr int kVoxelsPerEdge = 64;
constexpr int kPositionBits = 9;  // 8 steps per voxel
constexpr int kNormalBits = 8;
constexpr int kSpeed = 7;
constexpr float kNormalScale = 32767.0f;
static_assert(kVoxelEdge_m * kVoxelsPerEdge == kChunkEdge_m,
              "voxel and chunk borders must be the same floats");
static_assert(kVoxelsPerEdge * kVoxelsPerEdge * kVoxelsPerEdge == kMaxPointsPerChunk);

double scale_of(std::uint8_t level) { return static_cast<double>(1u << level); }

// Returns the index of the submap's voxel that contains a coordinate, in double precision, since
// float rounding would move points across the border.
std::int64_t voxel_of(float coordinate_m, std::uint8_t level) {
  return static_cast<std::int64_t>(std::floor(
      static_cast<double>(coordinate_m) / (static_cast<double>(kVoxelEdge_m) * scale_of(level))));
}

// Arithmetic shift, which also rounds down for negative voxels.
std::int64_t chunk_of_voxel(std::int64_t voxel) { return voxel >> 6; }

std::optional<ChunkKey> key_of(const CloudPoint& point, std::uint8_t level) {
  const double reach_m = 32768.0 * static_cast<double>(kChunkEdge_m) * scale_of(level);
  std::array<std::int16_t, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const float coordinate_m = point.position_m[axis];
    // Also true for NaN.
    if (!(std::abs(static_cast<double>(coordinate_m)) <= reach_m)) return std::nullopt;
    const std::int64_t chunk = chunk_of_voxel(voxel_of(coordinate_m, level));
    if (chunk < std::numeric_limits<std::int16_t>::min() ||
        chunk > std::numeric_limits<std::int16_t>::max())
      return std::nullopt;
    cell[static_cast<std::size_t>(axis)] = static_cast<std::int16_t>(chunk);
  }
  return ChunkKey{point.submap, level, cell[0], cell[1], cell[2]};
}

// Interleaves the bits of three numbers below 64: spatial neighbours become neighbours in the
// stream, in which Draco stores differences.
std::uint32_t morton_code(const Eigen::Vector3f& position_m, std::uint8_t level) {
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto local =
        static_cast<std::uint32_t>(voxel_of(position_m[axis], level) & (kVoxelsPerEdge - 1));
    for (int bit = 0; bit < 6; ++bit) code |= ((local >> bit) & 1u) << (3 * bit + axis);
  }
  return code;
}

// The points of one chunk as arrays for Draco.
struct Columns {
  std::vector<std::array<float, 3>> positions_m, normals;  // normals is empty if no point has one
  std::vector<Rgb8> colors;
  std::vector<std::uint8_t> confidences;
};

template <class Row>
void add_attribute(draco::PointCloudBuilder& builder, draco::GeometryAttribute::Type type,
                   draco::DataType data_type, const std::vector<Row>& rows) {
  constexpr auto kComponents = static_cast<std::int8_t>(sizeof(Row) == 1 ? 1 : 3);
  const int id = builder.AddAttribute(type, kComponents, data_type);
  builder.SetAttributeValuesForAllPoints(id, rows.data(), sizeof(Row));
}

// The quantisation grid: cell i of an axis spans steps i to i+1 from the chunk's corner and decodes
// to its centre. So all chunks share one grid of 1/8 voxel, the error is at most half a step, and
// the last cell fits 9 bits.
struct Grid {
  std::array<float, 3> first_m{};  // centre of cell 0
  float range_m = 0;               // from there to the centre of the last cell

  explicit Grid(const ChunkKey& key) {
    const double edge_m = static_cast<double>(kChunkEdge_m) * scale_of(key.level),
                 step_m = edge_m / (1 << kPositionBits);
    const std::array<std::int16_t, 3> cell = {key.x, key.y, key.z};
    for (std::size_t axis = 0; axis < 3; ++axis)
      first_m[axis] = static_cast<float>(cell[axis] * edge_m + step_m / 2);
    range_m = static_cast<float>(step_m * ((1 << kPositionBits) - 1));
  }

  // Clamps to the range that Draco quantises; the outer half steps belong to the outer cells.
  std::array<float, 3> clamped(const Eigen::Vector3f& position_m) const {
    std::array<float, 3> result{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result[axis] =
          std::clamp(position_m[static_cast<int>(axis)], first_m[axis], first_m[axis] + range_m);
    }
    return result;
  }
};

Error refused(const std::string& message) {
  return {ErrorCode::kUnsupported, "Draco failed to encode a chunk: " + message};
}

Result<std::string> encode_draco(const Columns& columns, const Grid& grid) {
  draco::PointCloudBuilder builder;
  builder.Start(static_cast<draco::PointIndex::ValueType>(columns.positions_m.size()));
  add_attribute(builder, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32,
                columns.positions_m);
  add_attribute(builder, draco::GeometryAttribute::COLOR, draco::DT_UINT8, columns.colors);
  if (!columns.normals.empty())
    add_attribute(builder, draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, columns.normals);
  add_attribute(builder, draco::GeometryAttribute::GENERIC, draco::DT_UINT8, columns.confidences);
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  if (!cloud) return refused("no point cloud");

  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetSpeedOptions(kSpeed, kSpeed);
  encoder.SetAttributeExplicitQuantization(draco::GeometryAttribute::POSITION, kPositionBits, 3,
                                           grid.first_m.data(), grid.range_m);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, kNormalBits);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodePointCloudToBuffer(*cloud, &buffer);
  if (!status.ok()) return refused(status.error_msg_string());
  return std::string(buffer.data(), buffer.size());
}

}  // namespace

ChunkedModel::ChunkedModel(std::uint8_t level, double least_confidence)
    : level_(level), least_confidence_(least_confidence) {
  CHECK(level <= kCoarsestLevel, fmt::format("level {} of chunks", level));
}

std::size_t ChunkedModel::KeyHash::operator()(const ChunkKey& key) const {
  // Multiplicative hash of the key's 88 bits.
  constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15ull;
  const std::uint64_t cell = (std::uint64_t{static_cast<std::uint16_t>(key.x)} << 32) |
                             (std::uint64_t{static_cast<std::uint16_t>(key.y)} << 16) |
                             std::uint64_t{static_cast<std::uint16_t>(key.z)};
  const std::uint64_t mixed =
      (cell * kOdd) ^ (((std::uint64_t{key.submap} << 8) | key.level) * (kOdd >> 8 | 1u));
  return static_cast<std::size_t>(mixed ^ (mixed >> 29));
}

std::optional<ChunkedModel::Entry> ChunkedModel::compact(const CloudPoint& point) {
  if (!point.position_m.allFinite() || !point.normal.allFinite() ||
      !std::isfinite(point.confidence))
    return std::nullopt;
  Entry entry;
  entry.position_m = point.position_m;
  entry.confidence = point.confidence;
  entry.color = point.color;
  entry.alive = true;
  const float length = point.normal.stableNorm();
  if (length > 0) {
    for (int axis = 0; axis < 3; ++axis) {
      entry.normal[static_cast<std::size_t>(axis)] =
          static_cast<std::int16_t>(std::lround(point.normal[axis] / length * kNormalScale));
    }
  }
  return entry;
}

std::uint32_t ChunkedModel::chunk_index(const ChunkKey& key) {
  const auto [found, is_new] =
      chunk_by_key_.try_emplace(key, static_cast<std::uint32_t>(chunks_.size()));
  if (is_new) chunks_.push_back({key, {}, false});
  return found->second;
}

void ChunkedModel::touch(std::uint32_t chunk) {
  if (chunks_[chunk].dirty) return;
  chunks_[chunk].dirty = true;
  dirty_.push_back(chunk);
}

void ChunkedModel::remove(std::uint32_t slot) {
  if (slot >= entries_.size() || !entries_[slot].alive) return;
  Entry& entry = entries_[slot];
  std::vector<std::uint32_t>& slots = chunks_[entry.chunk].slots;
  slots[entry.place] = slots.back();
  entries_[slots[entry.place]].place = entry.place;
  slots.pop_back();
  if (slots.empty()) slots.shrink_to_fit();
  touch(entry.chunk);
  entry = {};
}

void ChunkedModel::set(std::uint32_t slot, const CloudPoint& point) {
  const std::optional<ChunkKey> key = key_of(point, level_);
  std::optional<Entry> entry = compact(point);
  if (!key || !entry) {
    ++rejected_point_count_;
    remove(slot);
    return;
  }
  if (slot >= entries_.size()) entries_.resize(std::size_t{slot} + 1);
  Entry& old = entries_[slot];
  if (old.alive && chunks_[old.chunk].key == *key) {
    if (old.position_m == entry->position_m && old.confidence == entry->confidence &&
        old.normal == entry->normal && old.color == entry->color)
      return;
    entry->chunk = old.chunk;
    entry->place = old.place;
  } else {
    remove(slot);
    entry->chunk = chunk_index(*key);
    entry->place = static_cast<std::uint32_t>(chunks_[entry->chunk].slots.size());
    chunks_[entry->chunk].slots.push_back(slot);
  }
  old = *entry;
  touch(entry->chunk);
}

void ChunkedModel::apply(std::span<const SlotChange> changes) {
  for (const SlotChange& change : changes) {
    CHECK(change.slot < kMaxModelSlots,
          fmt::format("slot {} is not below {}", change.slot, kMaxModelSlots));
    const bool is_weak =
        least_confidence_ > 0 && static_cast<double>(change.point.confidence) < least_confidence_;
    if (change.alive && !is_weak) {
      set(change.slot, change.point);
    } else {
      remove(change.slot);
    }
  }
}

std::vector<ChunkKey> ChunkedModel::take_dirty() {
  std::vector<ChunkKey> keys;
  keys.reserve(dirty_.size());
  for (const std::uint32_t chunk : dirty_) {
    chunks_[chunk].dirty = false;
    keys.push_back(chunks_[chunk].key);
  }
  dirty_.clear();
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::vector<ChunkedModel::Candidate> ChunkedModel::visible_points(const Chunk& chunk) const {
  std::vector<Candidate> candidates;
  candidates.reserve(chunk.slots.size());
  for (const std::uint32_t slot : chunk.slots)
    candidates.push_back({morton_code(entries_[slot].position_m, level_), slot});
  std::sort(candidates.begin(), candidates.end(), [this](const Candidate& a, const Candidate& b) {
    if (a.voxel != b.voxel) return a.voxel < b.voxel;
    const float confidence_a = entries_[a.slot].confidence,
                confidence_b = entries_[b.slot].confidence;
    if (confidence_a != confidence_b) return confidence_a > confidence_b;
    return a.slot < b.slot;
  });
  const auto same_voxel = [](const Candidate& a, const Candidate& b) { return a.voxel == b.voxel; };
  // Keeps the first of each voxel.
  candidates.erase(std::unique(candidates.begin(), candidates.end(), same_voxel), candidates.end());
  return candidates;
}

Result<EncodedChunk> ChunkedModel::encode(const ChunkKey& key) const {
  EncodedChunk encoded;
  encoded.key = key;
  const auto found = chunk_by_key_.find(key);
  if (found == chunk_by_key_.end() || chunks_[found->second].slots.empty()) return encoded;

  const std::vector<Candidate> points = visible_points(chunks_[found->second]);
  const Grid grid(key);
  Columns columns;
  bool has_normals = false;
  for (const Candidate& candidate : points) {
    const Entry& entry = entries_[candidate.slot];
    columns.positions_m.push_back(grid.clamped(entry.position_m));
    columns.colors.push_back(entry.color);
    columns.normals.push_back({entry.normal[0] / kNormalScale, entry.normal[1] / kNormalScale,
                               entry.normal[2] / kNormalScale});
    has_normals |= entry.normal != std::array<std::int16_t, 3>{};
    columns.confidences.push_back(eighths_of_confidence(entry.confidence));
  }
  // An octahedral code has no value for "none", so zeros would decode to some direction.
  if (!has_normals) columns.normals.clear();
  try {  // Draco allocates by sizes in the data and may throw
    Result<std::string> draco = encode_draco(columns, grid);
    if (!draco.ok()) return draco.error();
    encoded.draco = *std::move(draco);
  } catch (const std::exception& exception) {
    return refused(exception.what());
  }
  encoded.point_count = static_cast<std::uint32_t>(points.size());
  return encoded;
}

}  // namespace hermite::output
