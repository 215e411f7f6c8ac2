#include "server/service/audit.h"

#include <fcntl.h>
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

#include "core/digest/sha256.h"
#include "server/store/unix_time.h"

namespace hermite {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxWaitingEntries = 10'000;  // 3 MB
constexpr std::int64_t kWrongTokensPeriod_ms = 60'000;
constexpr std::string_view kHashField = ",\"hash\":\"";
const std::string kNoEntryBefore(64, '0');

std::string file_name(int number) {
  char name[32];
  std::snprintf(name, sizeof name, "audit-%06d.jsonl", number);
  return name;
}

std::optional<int> number_of(const std::string& name) {
  int number = 0;
  if (std::sscanf(name.c_str(), "audit-%6d.jsonl", &number) != 1 || name != file_name(number)) return std::nullopt;
  return number;
}

// Oldest first.
std::vector<int> file_numbers(const std::string& folder) {
  std::vector<int> numbers;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (const std::optional<int> number = number_of(entry->path().filename())) numbers.push_back(*number);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

Error audit_error(const std::string& what) { return {ErrorCode::kIo, "the audit log: " + what + ": " + std::strerror(errno)}; }

// The line without its hash, and the hash that it says; nothing when it has none at its end.
std::optional<std::pair<std::string, std::string>> take_hash(const std::string& line) {
  const std::size_t at = line.rfind(kHashField);
  if (at == std::string::npos || line.size() != at + kHashField.size() + 64 + 2) return std::nullopt;
  return std::pair(line.substr(0, at) + "}", line.substr(at + kHashField.size(), 64));
}

// For the log, which takes what is as long as a token for one.
std::string start_of(const std::string& hash) { return hash.substr(0, 16); }

// What is wrong with the line behind that head; nothing when it fits, and then it is the head.
std::optional<std::string> follow(const std::string& line, std::string& head, std::uint64_t& count, bool first) {
  const auto parts = take_hash(line);
  if (!parts) return "is no entry";
  const Json json = Json::parse(parts->first, nullptr, false);
  if (!json.is_object() || !json.contains("n") || !json["n"].is_number_unsigned() || !json.contains("prev")) return "is no entry";
  if (sha256_hex(parts->first) != parts->second) return "was changed";
  // The oldest file may have gone with its entries.
  if (!first && (json["prev"] != head || json["n"] != count + 1)) return "does not follow the one before it";
  head = parts->second;
  count = json["n"];
  return std::nullopt;
}

}  // namespace

Audit::Audit(std::string folder, std::int64_t now_ms)
    : folder_(std::move(folder)), head_(kNoEntryBefore), wrong_tokens_written_at_ms_(now_ms) {
  if (mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST) throw SetupError(audit_error("creating " + folder_));
  open_last_file();
}

Audit::~Audit() {
  note_wrong_tokens(unix_now_ms());
  if (const Status written = write_waiting(); !written.ok())
    spdlog::error("{} entries are lost: {}", waiting_.size(), written.error().message);
  if (file_ >= 0) {
    fdatasync(file_);
    close(file_);
  }
}

void Audit::open_last_file() {
  const std::vector<int> numbers = file_numbers(folder_);
  if (numbers.empty()) {
    if (const Status opened = open_next_file(); !opened.ok()) throw SetupError(opened.error());
    return;
  }
  file_number_ = numbers.back();
  const std::string path = folder_ + "/" + file_name(file_number_);
  file_ = open(path.c_str(), O_RDWR | O_APPEND | O_CLOEXEC | O_NOFOLLOW);
  if (file_ < 0) throw SetupError(audit_error("opening " + path));
  // Of the files before it only the last line is needed where this one is empty; a chain that is broken is check_audit()'s to find.
  std::uint64_t good_bytes = 0;
  for (const int number : numbers) {
    if (number != numbers.back() && number != numbers.back() - 1) continue;
    std::ifstream file(folder_ + "/" + file_name(number), std::ios::binary);
    good_bytes = 0;
    for (std::string line; std::getline(file, line) && !file.eof();) {
      good_bytes += line.size() + 1;
      follow(line, head_, count_, true);
    }
  }
  if (ftruncate(file_, static_cast<off_t>(good_bytes)) != 0) throw SetupError(audit_error("cutting " + path));
  file_bytes_ = good_bytes;
}

Status Audit::open_next_file() {
  const std::string path = folder_ + "/" + file_name(file_number_ + 1);
  const int next = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (next < 0) return audit_error("creating " + path);
  if (file_ >= 0) {
    fdatasync(file_);
    close(file_);
    spdlog::info("the audit log has a new file behind entry {}, {}", count_, start_of(head_));
  }
  file_ = next;
  file_bytes_ = 0;
  ++file_number_;
  std::vector<int> numbers = file_numbers(folder_);
  for (std::size_t i = 0; i + kMaxAuditFiles < numbers.size(); ++i) unlink((folder_ + "/" + file_name(numbers[i])).c_str());
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
  const std::string hash = sha256_hex(body);
  const std::string line = body.substr(0, body.size() - 1) + std::string(kHashField) + hash + "\"}\n";
  const ssize_t written = ::write(file_, line.data(), line.size());
  if (written != static_cast<ssize_t>(line.size())) {
    const Error error = audit_error("writing");
    // Half a line must not stand before the next.
    if (written > 0 && ftruncate(file_, static_cast<off_t>(file_bytes_)) != 0) spdlog::error("{}", audit_error("cutting").message);
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
    const AuditEntry lost{unix_now_ms(), "", "", "audit entries lost", "", "the disk took none", lost_count_};
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
  if (waiting_.size() >= kMaxWaitingEntries)
    ++lost_count_;
  else
    waiting_.push_back(std::move(entry));
  // While the disk says no, tick() tries again.
  if (waiting_.size() == 1)
    if (const Status written = write_waiting(); !written.ok()) spdlog::error("{}", written.error().message);
}

void Audit::wrong_token(const std::string& address) {
  const bool room = wrong_tokens_.contains(address) || wrong_tokens_.size() < kMaxCountedAddresses;
  ++wrong_tokens_[room ? address : std::string(kOtherAddresses)];
}

void Audit::note_wrong_tokens(std::int64_t now_ms) {
  wrong_tokens_written_at_ms_ = now_ms;
  for (const auto& [address, count] : std::exchange(wrong_tokens_, {})) note({now_ms, "", address, "wrong token", "", "refused", count});
}

void Audit::tick(std::int64_t now_ms) {
  if (std::abs(now_ms - wrong_tokens_written_at_ms_) >= kWrongTokensPeriod_ms) note_wrong_tokens(now_ms);
  if (!waiting_.empty() || lost_count_ > 0)
    if (const Status written = write_waiting(); !written.ok()) return;
  if (!unsynced_) return;
  unsynced_ = false;
  if (fdatasync(file_) != 0) spdlog::error("{}", audit_error("syncing").message);
}

Result<AuditCheck> check_audit(const std::string& folder, const std::function<void(const std::string& line)>& each) {
  AuditCheck check;
  check.head = kNoEntryBefore;
  bool first = true;
  for (const int number : file_numbers(folder)) {
    const std::string name = file_name(number);
    std::ifstream file(folder + "/" + name, std::ios::binary);
    if (!file) return Error{ErrorCode::kIo, "reading " + folder + "/" + name + ": " + std::strerror(errno)};
    int line_number = 0;
    for (std::string line; std::getline(file, line);) {
      ++line_number;
      each(line);
      if (!check.broken.empty()) continue;
      // The first file may begin in the middle; file 1 does not.
      if (const auto wrong = follow(line, check.head, check.entry_count, first && number != 1))
        check.broken = name + ", line " + std::to_string(line_number) + ": it " + *wrong;
      first = false;
    }
  }
  return check;
}

}  // namespace hermite
