#include "server/exports/build_comparison.h"

#include <fmt/core.h>

#include <mutex>
#include <utility>

#include "core/compare/compare.h"
#include "core/compare/compare_output.h"
#include "server/exports/export_spec.h"
#include "server/exports/result_sources.h"

namespace hermite::server {

namespace {

constexpr double kRead = 0.05, kCompared = 0.95;  // fractions of the time at which the steps end

struct Source {
  std::string scan_id, file;
  std::uint64_t size_bytes = 0;
};

Result<Source> source_of(Blobs& blobs, const std::string& scan_id) {
  for (const char* file : {kSurfelsFile, kCloudFile}) {
    const Result<std::uint64_t> size_bytes = blobs.size_bytes(scan_id, file);
    if (size_bytes.ok()) return Source{scan_id, file, *size_bytes};
    if (size_bytes.error().code != ErrorCode::kNotFound) return size_bytes.error();
  }
  return Error{ErrorCode::kNotFound, fmt::format("scan {} has no points", scan_id)};
}

Status check_memory(const Source& first, const Source& second, const FreeMemory& free_memory) {
  for (const Source& source : {first, second})
    if (source.size_bytes > kMaxComparedCloud_bytes)
      return Error{ErrorCode::kTooLarge,
                   fmt::format("scan {} has {} of points, at most {} are compared", source.scan_id,
                               mib(static_cast<double>(source.size_bytes)),
                               mib(static_cast<double>(kMaxComparedCloud_bytes)))};
  return check_free_memory(
      "comparing", kCompareMemory * static_cast<double>(first.size_bytes + second.size_bytes),
      free_memory);
}

// An imported scan has no path.
Result<dataset::Trajectory> path_if_any(Blobs& blobs, const std::string& scan_id) {
  Result<dataset::Trajectory> path = read_path(blobs, scan_id);
  return !path.ok() && path.error().code == ErrorCode::kNotFound
             ? Result<dataset::Trajectory>(dataset::Trajectory())
             : path;
}

// A scan without a report, such as an imported one, is in one part.
Result<std::int64_t> part_count_of(Blobs& blobs, const std::string& scan_id) {
  const Result<measure::MapKnowledge> map = read_map_knowledge(blobs, scan_id);
  if (!map.ok() && map.error().code == ErrorCode::kNotFound) return std::int64_t{1};
  return map.ok() ? Result<std::int64_t>(map->part_count) : map.error();
}

// `name` is how people are told of the scan.
Result<compare::ComparedScan> read_scan(Blobs& blobs, const Source& source, const char* name) {
  const Result<output::PlyShape> shape =
      read_ply(blobs, source.scan_id, source.file, kMaxComparedCloud_bytes);
  if (!shape.ok()) return shape.error();
  if (shape->positions.empty())
    return Error{ErrorCode::kInvalidArgument, std::string(name) + " has no points"};
  if (shape->normals.empty())
    return Error{
        ErrorCode::kInvalidArgument,
        std::string(name) + " has points without normals: the sides of its surface cannot be told"};
  Result<dataset::Trajectory> path = path_if_any(blobs, source.scan_id);
  if (!path.ok()) return path.error();
  const Result<std::int64_t> part_count = part_count_of(blobs, source.scan_id);
  if (!part_count.ok()) return part_count.error();
  Result<compare::ComparedScan> scan =
      compare::ComparedScan::create(output::cloud_of(*shape), *std::move(path), name);
  if (scan.ok()) scan->set_part_count(*part_count);
  return scan;
}

}  // namespace

Result<output::NamedFiles> build_comparison(Blobs& blobs, const FreeMemory& free_memory,
                                            const ComparedIds& ids, const BuildProgress& progress) {
  const Error stopped{ErrorCode::kBusy, "stopped"};
  if (!progress(0)) return stopped;
  const Result<Source> first_source = source_of(blobs, ids.first),
                       second_source = source_of(blobs, ids.second);
  if (!first_source.ok()) return first_source.error();
  if (!second_source.ok()) return second_source.error();
  if (const Status memory = check_memory(*first_source, *second_source, free_memory); !memory.ok())
    return memory.error();
  const Result<compare::ComparedScan> first = read_scan(blobs, *first_source, "the first scan");
  if (!first.ok()) return first.error();
  const Result<compare::ComparedScan> second = read_scan(blobs, *second_source, "the second scan");
  if (!second.ok()) return second.error();
  if (!progress(kRead)) return stopped;
  std::mutex mutex;  // several threads tell
  const Result<compare::Comparison> comparison =
      compare::compare_scans(*first, *second, compare::ChangeOptions(), [&](double done) {
        const std::lock_guard lock(mutex);
        return progress(kRead + (kCompared - kRead) * done);
      });
  if (!comparison.ok()) return comparison.error();
  output::NamedFiles files;
  if (comparison->registration.verdict == compare::RegistrationVerdict::kSamePlace)
    files.push_back(
        {comparison_points_file(ids.second), compare::format_compared_points_ply(*comparison)});
  files.push_back({comparison_with(ids.second).file(),
                   compare::format_comparison_json(*comparison, compare::ChangeOptions())});
  return progress(1) ? Result<output::NamedFiles>(std::move(files)) : stopped;
}

}  // namespace hermite::server
