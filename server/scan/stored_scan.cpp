#include "server/scan/stored_scan.h"

#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "core/adjust/mapping_counts.h"
#include "core/dataset/trajectory.h"
#include "core/report/reported_up.h"
#include "proto/wire/server_message.h"
#include "server/store/chunk_file.h"

namespace hermite::server {

namespace {

// Far above the results of kMaxFramesPerScan frames. A longer file is invalid and must not exhaust
// the memory.
constexpr std::size_t kMaxResultBytes = std::size_t{2} * 1024 * 1024 * 1024;

ModelUpdate model_of(StoredChunks stored) {
  ModelUpdate model;
  std::uint64_t version = 0;
  for (output::EncodedChunk& chunk : stored.chunks) {
    wire::Chunk message{{chunk.key.submap, chunk.key.level, chunk.key.x, chunk.key.y, chunk.key.z},
                        ++version,
                        chunk.point_count,
                        std::move(chunk.draco)};
    const bool empty = chunk.point_count == 0;
    model.chunks.push_back(
        {chunk.key, empty,
         std::make_shared<const std::string>(wire::format_server_message(std::move(message)))});
  }
  for (const StoredSubmap& submap : stored.submaps)
    model.poses.poses.push_back({submap.submap, submap.world_from_submap});
  return model;
}

}  // namespace

Result<wire::Finished> read_results(Blobs& blobs, const std::string& scan_id) {
  Result<std::string> report = read_blob(blobs, scan_id, "report.json", kMaxResultBytes);
  if (!report.ok()) return report.error();
  Result<std::string> trajectory = read_blob(blobs, scan_id, "trajectory.txt", kMaxResultBytes);
  if (!trajectory.ok()) return trajectory.error();
  return wire::Finished{*std::move(report), *std::move(trajectory)};
}

void read_map_counts(Blobs& blobs, const std::string& scan_id, wire::ScanState& state) {
  const Result<std::string> text = read_blob(blobs, scan_id, "report.json", kMaxResultBytes);
  if (!text.ok()) return;
  const nlohmann::json report = nlohmann::json::parse(*text, nullptr, false);
  const nlohmann::json mapping =
      report.is_object() ? report.value("mapping", nlohmann::json()) : nlohmann::json();
  adjust::MappingCounts counts;
  for (const adjust::MappingCountName& named : adjust::kMappingCountNames) {
    const auto found = mapping.is_object() ? mapping.find(named.name) : mapping.end();
    if (found != mapping.end() && found->is_number_unsigned())
      counts.*named.count = found->get<std::int64_t>();
  }
  state.keyframes = static_cast<std::uint64_t>(counts.keyframes);
  state.loops = static_cast<std::uint64_t>(counts.loops());
  state.up = report::up_in_report(*text);
}

StoredScan read_stored_scan(Blobs& blobs, const std::string& scan_id) {
  StoredScan scan;
  read_map_counts(blobs, scan_id, scan.map_counts);
  if (const Result<std::string> text = read_blob(blobs, scan_id, "trajectory.txt", kMaxResultBytes);
      text.ok()) {
    const Result<dataset::Trajectory> trajectory = dataset::parse_tum_trajectory(*text);
    if (!trajectory.ok())
      spdlog::error("trajectory.txt of scan {}: {}", scan_id, trajectory.error().message);
    for (const dataset::TimedPose& pose : trajectory.ok() ? *trajectory : dataset::Trajectory{})
      for (const double axis : pose.world_from_camera.translation)
        scan.positions_m.push_back(static_cast<float>(axis));
  }
  const Result<std::string> bytes = read_blob(blobs, scan_id, kChunksName, kMaxResultBytes);
  if (!bytes.ok()) return scan;
  Result<StoredChunks> stored = parse_chunk_file(*bytes);
  if (stored.ok())
    scan.model = model_of(*std::move(stored));
  else
    spdlog::error("{} of scan {}: {}", kChunksName, scan_id, stored.error().message);
  return scan;
}

}  // namespace hermite::server
