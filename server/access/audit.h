// Who did what to which scan or token, in files of their own that nothing thins: DATA/audit/audit-000001.jsonl and so on, one JSON object a
// line. Each has the hash of the one before, so that a line that was changed, taken out or put in shows (check_audit). What is cut off at
// the end shows by DATA/audit/head: number and hash of the last entry that is surely on the disk, behind those a digest of both. A start
// that finds less than that, or no head, has an entry of its own about it, so that it shows for ever. Who takes head away as well is seen
// by that entry, and by the number and hash that the server's log has of every start and every new file.
//
//   {"n": 7, "at": "2024-05-01T12:00:00.123Z", "token": id, "address": "10.0.0.1", "did": "DELETE scan", "to": id, "outcome": "200",
//    "count": 1, "prev": hash of entry 6, "hash": SHA-256 of this line as it would be without "hash"}
//
// Wrong tokens are counted by address and written once a minute, so that none is lost and nobody can fill a disk with them.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite {

inline constexpr std::uint64_t kMaxAuditFileBytes = 8 * 1024 * 1024;
inline constexpr int kMaxAuditFiles = 128;  // a gigabyte: the oldest go
inline constexpr std::size_t kMaxCountedAddresses = 4096;
inline constexpr const char* kOtherAddresses = "others";  // of those that are counted one by one no more fit

struct AuditEntry {
  std::int64_t at_ms = 0;  // Unix time
  std::string token_id;    // who; empty: nobody who was let in
  std::string address;
  std::string did;
  std::string to;  // id of a scan, token, upload or job; empty: none
  std::string outcome;
  std::int64_t count = 1;
};

// Belongs to one thread. Writes at once; what a disk does not take waits in memory, up to kMaxWaiting, and what is lost after that is said.
class Audit {
 public:
  // Goes on with what is in `folder`, which is made if need be; a last line that a crash has cut is removed. Throws SetupError.
  Audit(std::string folder, std::int64_t now_ms);
  ~Audit();
  Audit(const Audit&) = delete;
  Audit& operator=(const Audit&) = delete;

  void note(AuditEntry entry);
  void wrong_token(const std::string& address);
  void tick(std::int64_t now_ms);  // now and then: writes what waits and makes it durable

  // What a start has found to be missing at the end of what was there, in words; empty: nothing.
  const std::string& missing() const { return missing_; }
  std::uint64_t entry_count() const { return count_; }
  const std::string& head() const { return head_; }  // hash of the last entry

 private:
  void note_wrong_tokens(std::int64_t now_ms);
  Status write_waiting();
  Status write(const AuditEntry& entry);
  Status open_next_file();
  void open_last_file(std::int64_t now_ms);
  void open_head(const std::string& hash_at_head, std::int64_t now_ms);
  void keep_head();

  const std::string folder_;
  int head_file_ = -1;
  int file_ = -1;
  int file_number_ = 0;
  std::uint64_t file_bytes_ = 0;
  std::uint64_t count_ = 0;
  std::string head_;
  std::deque<AuditEntry> waiting_;
  std::int64_t lost_count_ = 0;
  std::map<std::string, std::int64_t> wrong_tokens_;  // by address, since they were written last
  std::int64_t wrong_tokens_written_at_ms_;
  bool unsynced_ = false;
  std::string missing_;
};

struct AuditCheck {
  std::uint64_t entry_count = 0;
  std::string head;                  // hash of the last good entry
  std::string broken;                // where the chain does not hold and why, or what is missing at its end; empty: it holds
  std::vector<std::string> remarks;  // starts that have found no head
};

// Reads all files of `folder`, oldest first, and calls `each` with every line; also while a server writes there. kIo.
Result<AuditCheck> check_audit(const std::string& folder, const std::function<void(const std::string& line)>& each);

}  // namespace hermite
