// The audit log records who did what to which scan or token. It has its own files, to which no log
// level applies: DATA/audit/audit-000001.jsonl and so on, with one JSON object per line. Each has
// the hash of the previous one, so that a changed, removed or inserted line is detected
// (check_audit). Removal of the last entries is detected with DATA/audit/head: number and hash of
// the last entry that is certainly on disk, followed by a digest of both. If a start finds fewer
// entries than that, or no head, it writes an entry that says so, which documents it permanently.
// If head is removed as well, that entry shows it, and so do the number and hash that the server
// writes to its own log at every start and for every new file.
//
//   {"n": 7, "at": "2024-05-01T12:00:00.123Z", "token": id, "address": "10.0.0.1",
//    "did": "DELETE scan", "to": id, "outcome": "200", "count": 1, "prev": hash of entry 6,
//    "hash": SHA-256 of this line without "hash"}
//
// Nobody can wash evidence out of the files that are kept by doing something harmless again and
// again: of each kind of action of a token the first kSingleEntries are entries of their own, and
// so are kSingleEntriesPerMinute of the others. The rest is counted by token, address, action and
// outcome, without loss, and so are wrong tokens by address. Counts are written once a minute, or
// as much later as it takes for no more than kCountsPerMinute.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/access/rate_limit.h"

namespace hermite::server {

inline constexpr std::uint64_t kMaxAuditFileBytes = 8 * 1024 * 1024;
inline constexpr int kMaxAuditFiles = 128;       // a gigabyte; the oldest are deleted
inline constexpr std::size_t kMaxCounts = 4096;  // that are kept at a time
// Stands for the addresses beyond kMaxCounts, and for what counted actions were done to.
inline constexpr const char* kOthers = "others";
// An entry has about 250 bytes. A token that repeats each of 50 actions all the time takes 36 MB a
// day, counts take 12 MB.
inline constexpr double kSingleEntries = 1000, kSingleEntriesPerMinute = 2;
inline constexpr std::size_t kCountsPerMinute = 32;

struct AuditEntry {
  std::int64_t at_ms = 0;  // Unix time
  std::string token_id;    // the actor; empty: nobody who was authenticated
  std::string address;
  std::string did;
  // Id of a scan, token, upload or job; empty: none; kOthers: of several, of which no more is
  // known.
  std::string to;
  std::string outcome;
  std::int64_t count = 1;
};

// Belongs to one thread. Writes immediately. Entries that cannot be written to disk wait in memory,
// up to kMaxWaitingEntries; the number of entries lost beyond that is recorded.
class Audit {
 public:
  // Continues the log in `folder`, which is created if necessary; removes a last line that a crash
  // has left incomplete. Throws SetupError.
  Audit(std::string folder, std::int64_t now_ms);
  ~Audit();
  Audit(const Audit&) = delete;
  Audit& operator=(const Audit&) = delete;

  void note(AuditEntry entry);
  void wrong_token(const std::string& address);
  void tick(std::int64_t now_ms);  // to be called regularly: writes waiting entries and syncs

  // Returns which last entries the start found missing, as text; empty: none.
  const std::string& missing() const { return missing_; }
  std::uint64_t entry_count() const { return count_; }
  const std::string& head() const { return head_; }  // hash of the last entry

 private:
  struct Counted {
    std::string token_id, address, did, outcome;
    auto operator<=>(const Counted&) const = default;
  };
  void count(Counted what);
  void write_counts(std::int64_t now_ms);
  void add(AuditEntry entry);
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
  // Limit for each token and action.
  RateLimit single_entries_{kSingleEntriesPerMinute / 60, kSingleEntries};
  // Counts since they were last written.
  std::map<Counted, std::int64_t> counts_;
  std::int64_t counts_written_at_ms_, counts_pause_ms_;
  bool unsynced_ = false;
  std::string missing_;
};

struct AuditCheck {
  std::uint64_t entry_count = 0;
  std::string head;  // hash of the last valid entry
  // Where the chain is broken and why, or what is missing at its end; empty: it is intact.
  std::string broken;
  std::vector<std::string> remarks;  // starts that found no head
};

// Reads all files of `folder`, oldest first, and calls `each` with every line; a server may be
// writing there. kIo.
Result<AuditCheck> check_audit(const std::string& folder,
                               const std::function<void(const std::string& line)>& each);

}  // namespace hermite::server
