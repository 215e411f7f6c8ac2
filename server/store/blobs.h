// The bulk results of scans: clouds, trajectories, reports, exports and whatever a scan leaves behind, each under the scan's id and a name.
// Kept in a folder (file_blobs.h) or, some day, in S3; what every implementation keeps is in tests/server/store/blobs_contract.h.
//
// Not here: frame logs and uploads. They grow by appending and are synced many times a second, what is acknowledged rests on them, and
// nobody but the server that writes them reads them: they stay files of its own disk (data_directory.h).
//
// What an implementation owes:
//   whole    A blob is there as it was put, or as it was before, and never in between: whoever reads, whatever dies.
//   durable  What was put and returned well survives the death of the process, and that of the machine if its disk keeps its word.
//   threads  Every call may come from every thread, and may block on a disk or a network.
//
// Put again under its name a blob is replaced; who reads one in pieces meanwhile may get some of both, so the results of a scan are put
// before anybody is told that it has ended, and not again after that. Exports (server/exports) come later, each before anybody is told
// that it is there, and not again while it is.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite {

// 1 to 64 of [a-z0-9._-], the first one a letter; does not end in ".tmp".
bool is_blob_name(std::string_view name);

struct BlobInfo {
  std::string name;
  std::uint64_t size_bytes = 0;
  bool operator==(const BlobInfo&) const = default;
};

// Ids and names that are none (is_scan_id, is_blob_name) are mistakes of the caller. Failures of the disk or network are kIo, in words.
class Blobs {
 public:
  virtual ~Blobs() = default;

  virtual Status put(const std::string& scan_id, const std::string& name, const std::string& bytes) = 0;

  // At most `max_bytes` from `offset` on: less where the blob ends, nothing behind its end. kNotFound.
  virtual Result<std::string> read(const std::string& scan_id, const std::string& name, std::uint64_t offset, std::size_t max_bytes) = 0;

  virtual Result<std::uint64_t> size_bytes(const std::string& scan_id, const std::string& name) = 0;  // kNotFound

  // Another one whenever a blob has been put again: an entity tag without its quotes, of [a-z0-9-]. kNotFound.
  virtual Result<std::string> version(const std::string& scan_id, const std::string& name) = 0;

  virtual Result<std::vector<BlobInfo>> list(const std::string& scan_id) = 0;  // by name; empty: it has none

  virtual Status remove(const std::string& scan_id) = 0;  // all of them; well, too, when there are none

  virtual Status remove(const std::string& scan_id, const std::string& name) = 0;  // this one; well, too, when there is none
};

// All of it. kNotFound, kIo; kTooLarge: more than `max_bytes`.
Result<std::string> read_blob(Blobs& blobs, const std::string& scan_id, const std::string& name, std::size_t max_bytes);

}  // namespace hermite
