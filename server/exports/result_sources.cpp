#include "server/exports/result_sources.h"

#include <fmt/core.h>

#include <fstream>
#include <utility>

#include "core/report/reported_up.h"

namespace hermite::server {

namespace {

// A day of 30 poses per second would be 250 MB, and no scan has that many.
constexpr std::size_t kMaxTrajectory_bytes = std::size_t{64} << 20,
                      kMaxReport_bytes = std::size_t{1} << 20;

}  // namespace

Result<output::PlyShape> read_ply(Blobs& blobs, const std::string& scan_id, const std::string& file,
                                  std::uint64_t max_bytes) {
  const Result<std::string> bytes = read_blob(blobs, scan_id, file, max_bytes);
  if (!bytes.ok()) return bytes.error();
  Result<output::PlyShape> shape = output::parse_ply(*bytes);
  return shape.ok() ? std::move(shape) : in_context(file, shape.error());
}

Result<dataset::Trajectory> read_path(Blobs& blobs, const std::string& scan_id) {
  const Result<std::string> text = read_blob(blobs, scan_id, kTrajectoryFile, kMaxTrajectory_bytes);
  if (!text.ok()) return text.error();
  Result<dataset::Trajectory> path = dataset::parse_tum_trajectory(*text);
  return path.ok() ? std::move(path) : in_context(kTrajectoryFile, path.error());
}

Result<measure::MapKnowledge> read_map_knowledge(Blobs& blobs, const std::string& scan_id) {
  const Result<std::string> trajectory =
      read_blob(blobs, scan_id, kTrajectoryFile, kMaxTrajectory_bytes);
  if (!trajectory.ok()) return trajectory.error();
  const Result<std::string> report = read_blob(blobs, scan_id, kReportFile, kMaxReport_bytes);
  if (!report.ok()) return report.error();
  return measure::map_knowledge_of(*trajectory, *report);
}

std::optional<UpDirection> read_measured_up(Blobs& blobs, const std::string& scan_id) {
  const Result<std::string> text = read_blob(blobs, scan_id, kReportFile, kMaxReport_bytes);
  return text.ok() ? report::up_in_report(*text) : std::nullopt;
}

std::uint64_t free_memory_bytes() {
  std::ifstream file("/proc/meminfo");
  for (std::string word; file >> word;) {
    std::uint64_t kib = 0;
    if (word == "MemAvailable:" && file >> kib) return kib * 1024;
  }
  return 0;
}

Status check_free_memory(const std::string& what, double needed_bytes,
                         const FreeMemory& free_memory) {
  const std::uint64_t free_bytes = free_memory();
  if (free_bytes == 0 || needed_bytes <= static_cast<double>(free_bytes)) return Done{};
  return Error{ErrorCode::kTooLarge,
               fmt::format("{} takes some {} of memory and this machine has {} left: it can be "
                           "asked for again when there is more",
                           what, mib(needed_bytes), mib(static_cast<double>(free_bytes)))};
}

std::string mib(double bytes) {
  return fmt::format("{} MiB", static_cast<std::uint64_t>(bytes / (1 << 20)));
}

}  // namespace hermite::server
