#include "server/store/chunk_file.h"

#include <fmt/core.h>

#include <bit>
#include <cmath>
#include <cstring>

namespace hermite::server {

namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are written as they lie in memory");
constexpr std::string_view kMagic = "HRMCHNK1";

template <class Number>
void put(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// Takes numbers from the front. `cut` is set once bytes were missing; from then on all numbers read
// as zero.
struct Reader {
  std::string_view rest;
  bool cut = false;

  std::string_view take(std::size_t count) {
    if (count > rest.size()) {
      cut = true;
      rest = {};
      return {};
    }
    const std::string_view taken = rest.substr(0, count);
    rest.remove_prefix(count);
    return taken;
  }
  template <class Number>
  Number number() {
    Number value{};
    const std::string_view bytes = take(sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
};

Error corrupt(const std::string& message) {
  return {ErrorCode::kCorruptData, "chunk file: " + message};
}

Result<StoredSubmap> read_submap(Reader& reader) {
  StoredSubmap stored;
  stored.submap = reader.number<std::uint32_t>();
  double values[7];
  for (double& value : values) value = reader.number<double>();
  stored.world_from_submap.translation = {values[0], values[1], values[2]};
  stored.world_from_submap.rotation =
      Eigen::Quaterniond(values[6], values[3], values[4], values[5]);
  const bool unit = std::abs(stored.world_from_submap.rotation.norm() - 1) < 1e-3;
  if (!unit || !stored.world_from_submap.translation.allFinite())
    return corrupt(fmt::format("the pose of submap {} is cut or none", stored.submap));
  return stored;
}

Result<output::EncodedChunk> read_chunk(Reader& reader) {
  output::EncodedChunk chunk;
  chunk.key.submap = reader.number<std::uint32_t>();
  chunk.key.level = reader.number<std::uint8_t>();
  chunk.key.x = reader.number<std::int16_t>();
  chunk.key.y = reader.number<std::int16_t>();
  chunk.key.z = reader.number<std::int16_t>();
  chunk.point_count = reader.number<std::uint32_t>();
  const std::uint32_t byte_count = reader.number<std::uint32_t>();
  if (chunk.point_count > output::kMaxPointsPerChunk)
    return corrupt(fmt::format("a chunk of {} points", chunk.point_count));
  chunk.draco = std::string(reader.take(byte_count));
  if (reader.cut) return corrupt("cut inside a chunk");
  return chunk;
}

}  // namespace

std::string format_chunk_file(const StoredChunks& stored) {
  std::string bytes(kMagic);
  put(bytes, static_cast<std::uint32_t>(stored.submaps.size()));
  for (const StoredSubmap& submap : stored.submaps) {
    const Rigid3& pose = submap.world_from_submap;
    put(bytes, submap.submap);
    for (const double value :
         {pose.translation.x(), pose.translation.y(), pose.translation.z(), pose.rotation.x(),
          pose.rotation.y(), pose.rotation.z(), pose.rotation.w()})
      put(bytes, value);
  }
  put(bytes, static_cast<std::uint32_t>(stored.chunks.size()));
  for (const output::EncodedChunk& chunk : stored.chunks) {
    put(bytes, chunk.key.submap);
    put(bytes, chunk.key.level);
    for (const std::int16_t axis : {chunk.key.x, chunk.key.y, chunk.key.z}) put(bytes, axis);
    put(bytes, chunk.point_count);
    put(bytes, static_cast<std::uint32_t>(chunk.draco.size()));
    bytes += chunk.draco;
  }
  return bytes;
}

Result<StoredChunks> parse_chunk_file(std::string_view bytes) {
  Reader reader{bytes};
  if (reader.take(kMagic.size()) != kMagic)
    return corrupt("does not start with " + std::string(kMagic));
  StoredChunks stored;
  // Counts are not trusted: nothing is reserved for a number in the file that the bytes do not bear
  // out.
  for (std::uint32_t left = reader.number<std::uint32_t>(); left > 0; --left) {
    Result<StoredSubmap> submap = read_submap(reader);
    if (!submap.ok()) return submap.error();
    stored.submaps.push_back(*submap);
  }
  for (std::uint32_t left = reader.number<std::uint32_t>(); left > 0; --left) {
    Result<output::EncodedChunk> chunk = read_chunk(reader);
    if (!chunk.ok()) return chunk.error();
    stored.chunks.push_back(*std::move(chunk));
  }
  if (reader.cut) return corrupt("cut");
  if (!reader.rest.empty())
    return corrupt(fmt::format("{} bytes behind the end", reader.rest.size()));
  return stored;
}

}  // namespace hermite::server
