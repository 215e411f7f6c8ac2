#include "server/access/audit.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/sync_path.h"
#include "core/digest/sha256.h"
#include "server/store/data_directory.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxWaitingEntries = 10'000;  // 3 MB
constexpr std::int64_t kMinute_ms = 60'000;
constexpr const char* kWrongToken = "wrong token";
constexpr std::string_view kHashField = ",\"hash\":\"";
const std::string kNoEntryBefore(64, '0');
// Values of "did" in entries about what a start found missing.
constexpr const char *kEntriesMissing = "audit entries missing",
                     *kHeadMissing = "audit head missing";
// Digits of the digest of a head: it detects partial writes, not manipulation.
constexpr std::size_t kHeadDigits = 16;

std::string file_name(int number) {
  char name[32];
  std::snprintf(name, sizeof name, "audit-%06d.jsonl", number);
  return name;
}

std::optional<int> number_of(const std::string& name) {
  int number = 0;
  if (std::sscanf(name.c_str(), "audit-%6d.jsonl", &number) != 1 || name != file_name(number))
    return std::nullopt;
  return number;
}

// Returns the numbers in ascending order.
std::vector<int> file_numbers(const std::string& folder) {
  std::vector<int> numbers;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (const std::optional<int> number = number_of(entry->path().filename()))
      numbers.push_back(*number);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

Error audit_error(const std::string& what) {
  return {ErrorCode::kIo, fmt::format("the audit log: {}: {}", what, std::strerror(errno))};
}

// Returns the line without its hash, and that hash; std::nullopt if it does not end with one.
std::optional<std::pair<std::string, std::string>> take_hash(const std::string& line) {
  const std::size_t at = line.rfind(kHashField);
  if (at == std::string::npos || line.size() != at + kHashField.size() + 64 + 2)
    return std::nullopt;
  return std::pair(line.substr(0, at) + "}", line.substr(at + kHashField.size(), 64));
}

// For the log, in which a text as long as a token would be redacted.
std::string start_of(const std::string& hash) { return hash.substr(0, 16); }

// Returns what is wrong with the entry that follows `head`; std::nullopt if it is valid, and then
// it becomes the head.
std::optional<std::string> follow(const std::string& line, std::string& head, std::uint64_t& count,
                                  bool first) {
  const auto parts = take_hash(line);
  if (!parts) return "is no entry";
  const Json json = Json::parse(parts->first, nullptr, false);
  if (!json.is_object() || !json.contains("n") || !json["n"].is_number_unsigned() ||
      !json.contains("prev"))
    return "is no entry";
  if (digest::sha256_hex(parts->first) != parts->second) return "was changed";
  // The oldest file and its entries may have been deleted.
  if (!first && (json["prev"] != head || json["n"] != count + 1))
    return "does not follow the one before it";
  head = parts->second;
  count = json["n"];
  return std::nullopt;
}

// Checks whether a valid entry says that others are missing before it.
void look_for_missing(const std::string& line, AuditCheck& check) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object() || !check.broken.empty()) return;
  const std::string message =
      fmt::format("entry {}: {}", check.entry_count, json.value("outcome", ""));
  if (json.value("did", "") == kEntriesMissing) check.broken = "before " + message;
  if (json.value("did", "") == kHeadMissing) check.remarks.push_back(message);
}

// The last entry that is certainly on disk.
struct Head {
  std::uint64_t count = 0;
  std::string hash;
};

// Returns a line of constant length, which overwrites the previous one, so that the file is never
// empty.
std::string head_line(const Head& head) {
  char number[24];
  std::snprintf(number, sizeof number, "%020llu", static_cast<unsigned long long>(head.count));
  const std::string line = std::string(number) + " " + head.hash;
  return fmt::format("{} {}\n", line, digest::sha256_hex(line).substr(0, kHeadDigits));
}

// Returns std::nullopt if there is no head, or it is damaged.
std::optional<Head> read_head(const std::string& folder) {
  std::ifstream file(folder + "/" + kAuditHeadName, std::ios::binary);
  Head head;
  std::string digest;
  if (!(file >> head.count >> head.hash >> digest) ||
      head_line(head).find(fmt::format(" {}\n", digest)) == std::string::npos)
    return std::nullopt;
  return head;
}

// Returns which entries up to `head` are missing, if there are `count` entries and entry head.count
// has `hash_at_head`.
std::string missing_message(const Head& head, std::uint64_t count,
                            const std::string& hash_at_head) {
  if (head.count > count)
    return fmt::format("{} entries are missing at the end: number {}, {}, was the last one",
                       head.count - count, head.count, head.hash);
  if (!hash_at_head.empty() && hash_at_head != head.hash)
    return fmt::format("entry {} is another one than {}, which was there", head.count, head.hash);
  return {};
}

}  // namespace

Audit::Audit(std::string folder, std::int64_t now_ms)
    : folder_(std::move(folder)),
      head_(kNoEntryBefore),
      counts_written_at_ms_(now_ms),
      counts_pause_ms_(kMinute_ms) {
  if (mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST)
    throw SetupError(audit_error("creating " + folder_));
  or_throw(sync_path(fs::path(folder_).parent_path()));
  open_last_file(now_ms);
}

Audit::~Audit() {
  write_counts(unix_now_ms());
  if (const Status written = write_waiting(); !written.ok())
    spdlog::error("{} entries are lost: {}", waiting_.size(), written.error().message);
  if (file_ >= 0) {
    if (fdatasync(file_) == 0) keep_head();
    close(file_);
  }
  if (head_file_ >= 0) close(head_file_);
}

void Audit::open_last_file(std::int64_t now_ms) {
  const std::vector<int> numbers = file_numbers(folder_);
  const std::optional<Head> head = read_head(folder_);
  if (numbers.empty()) {
    if (const Status opened = open_next_file(); !opened.ok()) throw SetupError(opened.error());
    return open_head("", now_ms);
  }
  file_number_ = numbers.back();
  const std::string path = folder_ + "/" + file_name(file_number_);
  file_ = open(path.c_str(), O_RDWR | O_APPEND | O_CLOEXEC | O_NOFOLLOW);
  if (file_ < 0) throw SetupError(audit_error("opening " + path));
  // If this file is empty, the last line of the previous one is needed, but nothing else of earlier
  // files. Broken chains are left to check_audit().
  std::uint64_t good_bytes = 0;
  std::string hash_at_head;  // of the entry with the number of the head, as it is in the file now
  for (const int number : numbers) {
    if (number != numbers.back() && number != numbers.back() - 1) continue;
    std::ifstream file(folder_ + "/" + file_name(number), std::ios::binary);
    good_bytes = 0;
    for (std::string line; std::getline(file, line) && !file.eof();) {
      good_bytes += line.size() + 1;
      follow(line, head_, count_, true);
      if (head && count_ == head->count) hash_at_head = head_;
    }
  }
  if (ftruncate(file_, static_cast<off_t>(good_bytes)) != 0)
    throw SetupError(audit_error("cutting " + path));
  file_bytes_ = good_bytes;
  open_head(hash_at_head, now_ms);
}

void Audit::open_head(const std::string& hash_at_head, std::int64_t now_ms) {
  const std::optional<Head> before = read_head(folder_);
  const std::string path = folder_ + "/" + kAuditHeadName;
  head_file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (head_file_ < 0) throw SetupError(audit_error("opening " + path));
  if (before) missing_ = missing_message(*before, count_, hash_at_head);
  const std::int64_t missing_count =
      before && before->count > count_ ? static_cast<std::int64_t>(before->count - count_) : 1;
  if (!missing_.empty())
    note({now_ms, "", "", kEntriesMissing, "", missing_, missing_count});
  else if (!before && count_ > 0)
    note({now_ms, "", "", kHeadMissing, "",
          "whether entries before this one are missing is not known"});
  // An entry about missing ones has to be on disk before the head that revealed it is overwritten.
  if (fdatasync(file_) != 0) throw SetupError(audit_error("syncing " + folder_));
  if (waiting_.empty()) keep_head();
  or_throw(sync_path(path));
  or_throw(sync_path(folder_));
}

// Written after the entries, so that it is never ahead of them. Not synced itself: a power failure
// leaves an older head, which is valid, too.
void Audit::keep_head() {
  const std::string line = head_line({count_, head_});
  if (pwrite(head_file_, line.data(), line.size(), 0) != static_cast<ssize_t>(line.size()))
    spdlog::error("{}", audit_error("writing its head").message);
}

Status Audit::open_next_file() {
  const std::string path = folder_ + "/" + file_name(file_number_ + 1);
  const int next =
      open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (next < 0) return audit_error("creating " + path);
  if (file_ >= 0) {
    fdatasync(file_);
    close(file_);
    spdlog::info("the audit log has a new file behind entry {}, {}", count_, start_of(head_));
  }
  file_ = next;
  file_bytes_ = 0;
  ++file_number_;
  if (Status synced = sync_path(folder_); !synced.ok()) spdlog::error("{}", synced.error().message);
  std::vector<int> numbers = file_numbers(folder_);
  for (std::size_t i = 0; i + kMaxAuditFiles < numbers.size(); ++i)
    unlink((folder_ + "/" + file_name(numbers[i])).c_str());
  return Done{};
}

Status Audit::write(const AuditEntry& entry) {
  if (file_bytes_ >= kMaxAuditFileBytes)
    if (Status status = open_next_file(); !status.ok()) return status;
  Json json = {{"n", count_ + 1},
               {"at", utc_text(entry.at_ms)},
               {"token", entry.token_id},
               {"address", entry.address},
               {"did", entry.did},
               {"to", entry.to},
               {"outcome", entry.outcome},
               {"count", entry.count},
               {"prev", head_}};
  const std::string body = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string hash = digest::sha256_hex(body);
  const std::string line =
      body.substr(0, body.size() - 1) + std::string(kHashField) + hash + "\"}\n";
  const ssize_t written = ::write(file_, line.data(), line.size());
  if (written != static_cast<ssize_t>(line.size())) {
    const Error error = audit_error("writing");
    // A partial line must not remain before the next one.
    if (written > 0 && ftruncate(file_, static_cast<off_t>(file_bytes_)) != 0)
      spdlog::error("{}", audit_error("cutting").message);
    return error;
  }
  file_bytes_ += line.size();
  head_ = hash;
  ++count_;
  unsynced_ = true;
  return Done{};
}

Status Audit::write_waiting() {
  if (lost_count_ > 0) {
    const AuditEntry lost{unix_now_ms(),        "",         "", "audit entries lost", "",
                          "the disk took none", lost_count_};
    if (Status status = write(lost); !status.ok()) return status;
    lost_count_ = 0;
  }
  while (!waiting_.empty()) {
    if (Status status = write(waiting_.front()); !status.ok()) return status;
    waiting_.pop_front();
  }
  return Done{};
}

void Audit::note(AuditEntry entry) {
  const std::string& who = entry.token_id.empty() ? entry.address : entry.token_id;
  // What the server does itself is always an entry.
  if (!who.empty() && single_entries_.take(who + " " + entry.did, entry.at_ms) > 0)
    count({entry.token_id, entry.address, entry.did, entry.outcome});
  else
    add(std::move(entry));
}

void Audit::add(AuditEntry entry) {
  if (waiting_.size() >= kMaxWaitingEntries)
    ++lost_count_;
  else
    waiting_.push_back(std::move(entry));
  // While the disk fails, tick() tries again.
  if (waiting_.size() == 1)
    if (const Status written = write_waiting(); !written.ok())
      spdlog::error("{}", written.error().message);
}

void Audit::wrong_token(const std::string& address) {
  count({"", address, kWrongToken, "refused"});
}

void Audit::count(Counted what) {
  // The kinds of actions, outcomes and tokens are few, and addresses are as many as somebody likes.
  if (!counts_.contains(what) && counts_.size() >= kMaxCounts) what.address = kOthers;
  if (!counts_.contains(what) && counts_.size() >= 2 * kMaxCounts) what.token_id = kOthers;
  ++counts_[std::move(what)];
}

void Audit::write_counts(std::int64_t now_ms) {
  counts_written_at_ms_ = now_ms;
  counts_pause_ms_ =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(counts_.size() / kCountsPerMinute)) *
      kMinute_ms;
  for (const auto& [what, count] : std::exchange(counts_, {}))
    add({now_ms, what.token_id, what.address, what.did, what.did == kWrongToken ? "" : kOthers,
         what.outcome, count});
}

void Audit::tick(std::int64_t now_ms) {
  if (std::abs(now_ms - counts_written_at_ms_) >= counts_pause_ms_) write_counts(now_ms);
  if (!waiting_.empty() || lost_count_ > 0)
    if (const Status written = write_waiting(); !written.ok()) return;
  if (!unsynced_) return;
  unsynced_ = false;
  if (fdatasync(file_) != 0) return spdlog::error("{}", audit_error("syncing " + folder_).message);
  keep_head();
}

Result<AuditCheck> check_audit(const std::string& folder,
                               const std::function<void(const std::string& line)>& each) {
  AuditCheck check;
  check.head = kNoEntryBefore;
  bool first = true;
  // Read before the files, which may grow meanwhile.
  const std::optional<Head> head = read_head(folder);
  std::string hash_at_head;
  for (const int number : file_numbers(folder)) {
    const std::string name = file_name(number);
    std::ifstream file(folder + "/" + name, std::ios::binary);
    if (!file)
      return Error{ErrorCode::kIo,
                   fmt::format("reading {}/{}: {}", folder, name, std::strerror(errno))};
    int line_number = 0;
    for (std::string line; std::getline(file, line);) {
      ++line_number;
      each(line);
      if (!check.broken.empty()) continue;
      // The first remaining file may begin in the middle of the chain, but file 1 does not.
      if (const auto wrong = follow(line, check.head, check.entry_count, first && number != 1))
        check.broken = fmt::format("{}, line {}: it {}", name, line_number, *wrong);
      first = false;
      if (head && check.entry_count == head->count) hash_at_head = check.head;
      look_for_missing(line, check);
    }
  }
  if (!check.broken.empty()) return check;
  if (head)
    check.broken = missing_message(*head, check.entry_count, hash_at_head);
  else if (check.entry_count > 0)
    check.broken = fmt::format(
        "there is no {}: whether entries are missing at the end is not known", kAuditHeadName);
  return check;
}

}  // namespace hermite::server
