#include "server/exports/export_files.h"

#include <fmt/core.h>

#include <algorithm>

#include "server/exports/result_sources.h"

namespace hermite::server {

std::vector<std::string> sources_of(const ExportOffer& format) {
  if (format.is_result) return {std::string(format.file)};
  switch (format.kind) {
    case ExportKind::kMesh: return {std::string(kImportedMeshFile), kCloudFile};
    case ExportKind::kCloud: return {kCloudFile};
    case ExportKind::kPlan: return {kSurfelsFile, kCloudFile};
    case ExportKind::kPath: return {kTrajectoryFile};
    case ExportKind::kComparison: return {kSurfelsFile, kCloudFile};
  }
  return {};
}

Result<std::uint64_t> source_bytes(Blobs& blobs, const std::string& scan_id,
                                   const ExportOffer& format) {
  for (const std::string& source : sources_of(format)) {
    Result<std::uint64_t> size_bytes = blobs.size_bytes(scan_id, source);
    if (size_bytes.ok() || size_bytes.error().code != ErrorCode::kNotFound) return size_bytes;
  }
  return Error{ErrorCode::kNotFound,
               fmt::format("scan {} has no {}", scan_id, sources_of(format).back())};
}

Status put_export(Blobs& blobs, const std::string& scan_id, const ExportSpec& spec,
                  const output::NamedFiles& files) {
  if (spec.is_comparison())
    if (Status put = blobs.put(spec.other_scan_id, comparison_mark(scan_id), scan_id + "\n");
        !put.ok())
      return put;
  for (const output::NamedFile& file : files)
    if (Status put = blobs.put(scan_id, file.name, file.bytes); !put.ok()) return put;
  return Done{};
}

Status remove_export(Blobs& blobs, const std::string& scan_id, const ExportSpec& spec) {
  std::vector<std::string> files = spec.files();
  std::reverse(files.begin(), files.end());
  for (const std::string& file : files)
    if (Status removed = blobs.remove(scan_id, file); !removed.ok()) return removed;
  return spec.is_comparison() ? blobs.remove(spec.other_scan_id, comparison_mark(scan_id))
                              : Status(Done{});
}

}  // namespace hermite::server
