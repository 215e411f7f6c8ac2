#include "server/slurm/take_result.h"

#include <cstddef>
#include <filesystem>
#include <system_error>

#include "core/base/sync_path.h"
#include "core/dataset/text_file.h"
#include "server/scan/checkpoint_file.h"
#include "server/slurm/attempts.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

// As of what is read of an ended scan (stored_scan.cpp): far above the results of any scan.
constexpr std::size_t kMaxTakenBytes = std::size_t{2} * 1024 * 1024 * 1024;

Status take_blob(const fs::path& path, const std::string& scan_id, Blobs& blobs) {
  const Result<std::string> bytes = dataset::read_text_file(path.string(), kMaxTakenBytes);
  if (!bytes.ok()) return bytes.error();
  return blobs.put(scan_id, path.filename().string(), *bytes);
}

}  // namespace

Status take_result(const std::string& result_folder, const std::string& scan_id,
                   const DataDirectory& data, Blobs& blobs) {
  std::error_code error;
  if (!fs::exists(data.scan_folder(scan_id), error))
    if (Status made = data.create_scan_folder(scan_id); !made.ok()) return made;
  for (fs::directory_iterator entry(result_folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    const std::string name = entry->path().filename();
    if (!fs::is_regular_file(entry->symlink_status(gone)) || !is_blob_name(name) ||
        name == kCheckpointName)
      continue;
    if (Status taken = take_blob(entry->path(), scan_id, blobs); !taken.ok()) return taken;
  }
  if (error) return Error{ErrorCode::kIo, "reading the result of the node: " + error.message()};
  if (Status linked = link_files(result_folder + "/log", data.log_folder(scan_id)); !linked.ok())
    return Error{ErrorCode::kIo, "taking the frames of the node: " + linked.error().message};
  if (Status synced = sync_path(data.scan_folder(scan_id)); !synced.ok()) return synced;
  return sync_path(data.scans_folder());
}

}  // namespace hermite::server
