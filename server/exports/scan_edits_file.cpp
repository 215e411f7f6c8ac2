#include "server/exports/scan_edits_file.h"

#include <utility>

namespace hermite::server {

Result<edit::ScanEdits> read_edits(Blobs& blobs, const std::string& scan_id) {
  const Result<std::string> text = read_blob(blobs, scan_id, kEditsFile, kMaxEdits_bytes);
  if (!text.ok())
    return text.error().code == ErrorCode::kNotFound ? Result<edit::ScanEdits>(edit::ScanEdits{})
                                                     : text.error();
  Result<edit::ScanEdits> edits = edit::parse_scan_edits(*text);
  if (!edits.ok())
    return Error{ErrorCode::kCorruptData, std::string(kEditsFile) + ": " + edits.error().message};
  return edits;
}

}  // namespace hermite::server
