// What exports are made from: results of ended scans, read with a limit, and the memory that is
// left for that. Blocking; one thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"
#include "core/math/up_direction.h"
#include "core/measure/measure.h"
#include "core/output/ply_reader.h"
#include "server/store/blobs.h"

namespace hermite::server {

inline constexpr const char* kCloudFile = "cloud.ply";
// Scans of older servers and imported ones have none.
inline constexpr const char* kSurfelsFile = "surfels.ply";
inline constexpr const char* kTrajectoryFile = "trajectory.txt";
inline constexpr const char* kReportFile = "report.json";

// A cloud of twenty million points.
inline constexpr std::uint64_t kMaxExportCloud_bytes = std::uint64_t{1} << 30;

// Errors as read_blob(), and kCorruptData, which begins with the name of the file.
Result<output::PlyShape> read_ply(Blobs& blobs, const std::string& scan_id, const std::string& file,
                                  std::uint64_t max_bytes);
Result<dataset::Trajectory> read_path(Blobs& blobs, const std::string& scan_id);
Result<measure::MapKnowledge> read_map_knowledge(Blobs& blobs, const std::string& scan_id);
// Nullopt also where the scan has no report.
std::optional<UpDirection> read_measured_up(Blobs& blobs, const std::string& scan_id);

// Memory that is available without swapping (MemAvailable of Linux); 0: unknown.
using FreeMemory = std::function<std::uint64_t()>;
std::uint64_t free_memory_bytes();

// kTooLarge: there is less. `what` is what takes the memory.
Status check_free_memory(const std::string& what, double needed_bytes,
                         const FreeMemory& free_memory);

// "12 MiB", for messages.
std::string mib(double bytes);

}  // namespace hermite::server
