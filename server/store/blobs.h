// The large results of scans: clouds, trajectories, reports, exports and other files, each under
// the id of its scan and a name. Stored in a folder (file_blobs.h) or in S3
// (server/s3/remote_blobs.h); the tests in tests/server/store/blobs_contract.h apply to every
// implementation.
//
// Frame logs and uploads are not blobs. They are appended to and synced many times per second,
// acknowledgements depend on them, and only the server that writes them reads them, so they are
// files on its own disk (data_directory.h).
//
// Every implementation guarantees:
//   whole    A blob is as it was put or as it was before, never in between, for every reader and
//            whatever crashes.
//   durable  After put has succeeded, the blob survives the death of the process, and that of the
//            machine if its disk honours syncs.
//   threads  Every function may be called from every thread, and may block on a disk or a network.
//
// Putting a blob under an existing name replaces it; a reader that reads it in pieces meanwhile may
// get parts of both. So the results of a scan are put before its end is announced, and not again
// after that. Exports (server/exports) come later, each put before it is announced, and not again
// while it exists.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

// 1 to 64 characters of [a-z0-9._-], of which the first is a letter; does not end in ".tmp".
bool is_blob_name(std::string_view name);

struct BlobInfo {
  std::string name;
  std::uint64_t size_bytes = 0;
  bool operator==(const BlobInfo&) const = default;
};

// Invalid ids and names (is_scan_id, is_blob_name) are mistakes of the caller. Failures of the disk
// or network are kIo, with a message.
class Blobs {
 public:
  virtual ~Blobs() = default;

  virtual Status put(const std::string& scan_id, const std::string& name,
                     const std::string& bytes) = 0;

  // Returns at most `max_bytes` from `offset` on: fewer at the end of the blob, none beyond it.
  // kNotFound.
  virtual Result<std::string> read(const std::string& scan_id, const std::string& name,
                                   std::uint64_t offset, std::size_t max_bytes) = 0;

  // kNotFound.
  virtual Result<std::uint64_t> size_bytes(const std::string& scan_id, const std::string& name) = 0;

  // Returns an entity tag without its quotes, of [a-z0-9-], which differs whenever other bytes have
  // been put. kNotFound.
  virtual Result<std::string> version(const std::string& scan_id, const std::string& name) = 0;

  // Sorted by name; empty if it has none.
  virtual Result<std::vector<BlobInfo>> list(const std::string& scan_id) = 0;

  // All blobs of the scan; succeeds if there are none.
  virtual Status remove(const std::string& scan_id) = 0;

  // This blob; succeeds if it does not exist.
  virtual Status remove(const std::string& scan_id, const std::string& name) = 0;

  // Whether blobs can be put at present, as far as it is known without asking: what is on the own
  // disk has limits of its own. kIo, with a message: the store does not answer, and what has failed
  // for that reason is worth another attempt once it does.
  virtual Status availability() { return Done{}; }
};

// Reads a whole blob. kNotFound, kIo. kTooLarge: longer than `max_bytes`.
Result<std::string> read_blob(Blobs& blobs, const std::string& scan_id, const std::string& name,
                              std::size_t max_bytes);

}  // namespace hermite::server
