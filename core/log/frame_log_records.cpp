#include "core/log/frame_log_records.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "core/log/segment_file.h"

namespace hermite::frame_log {

namespace {

// A segment and the heads of its records, one after the other.
class SegmentWalk {
 public:
  SegmentWalk(std::unique_ptr<SegmentFile> file, std::uint32_t segment)
      : file_(std::move(file)), segment_(segment) {
    file_->expect_jumps();
  }

  // The next head with up to `beginning_bytes` behind it. None: the segment ends here, or is
  // damaged, and message() says so.
  Result<std::optional<RecordHeader>> next(std::size_t beginning_bytes) {
    if (offset_ == 0) {
      const Result<std::string> head = file_->read(0, kSegmentHeaderBytes);
      if (!head.ok()) return head.error();
      offset_ = kSegmentHeaderBytes;
      if (*head != format_segment_header(segment_)) return stop("no good header");
    }
    if (is_stopped_ || offset_ == file_->size_bytes()) return std::optional<RecordHeader>();
    Result<std::string> bytes = file_->read(offset_, kRecordHeaderBytes + beginning_bytes);
    if (!bytes.ok()) return bytes.error();
    const std::optional<RecordHeader> header =
        parse_record_header(std::string_view(*bytes).substr(0, kRecordHeaderBytes));
    record_offset_ = offset_;
    if (!header || offset_ + kRecordHeaderBytes + header->length > file_->size_bytes())
      return stop("no whole record");
    if (last_ && header->number != last_->number + 1)
      return stop("a record with another number than the next");
    beginning_ = bytes->substr(kRecordHeaderBytes, header->length);
    offset_ += kRecordHeaderBytes + header->length;
    last_ = header;
    return header;
  }

  // Of the record that next() gave last.
  const std::string& beginning() const { return beginning_; }
  Result<LogRecord> read() const {
    const Result<std::string> head = file_->read(record_offset_, kRecordHeaderBytes);
    if (!head.ok()) return head.error();
    Result<std::string> payload = file_->read(record_offset_ + kRecordHeaderBytes, last_->length);
    if (!payload.ok()) return payload.error();
    if (payload->size() != last_->length || !crc_fits(*head, *payload))
      return Error{ErrorCode::kCorruptData, where() + "the checksum is another one"};
    return LogRecord{last_->type, last_->number, *std::move(payload)};
  }

  const std::string& message() const { return message_; }

 private:
  std::string where() const {
    return fmt::format("{} at byte {}: ", segment_name(segment_), record_offset_);
  }
  std::optional<RecordHeader> stop(const char* message) {
    is_stopped_ = true;
    message_ = where() + message;
    return std::nullopt;
  }

  const std::unique_ptr<SegmentFile> file_;
  const std::uint32_t segment_;
  std::uint64_t offset_ = 0, record_offset_ = 0;  // bytes: of the next record, of the last one
  std::optional<RecordHeader> last_;
  std::string beginning_, message_;
  bool is_stopped_ = false;
};

// Null: there is no such segment.
Result<std::unique_ptr<SegmentWalk>> walk(const std::string& folder, std::uint32_t segment) {
  Result<std::unique_ptr<SegmentFile>> file = SegmentFile::open(folder, segment);
  if (!file.ok()) return file.error();
  if (!*file) return std::unique_ptr<SegmentWalk>();
  return std::make_unique<SegmentWalk>(*std::move(file), segment);
}

Error no_log(const std::string& folder) {
  return {ErrorCode::kNotFound, "there is no frame log in " + folder};
}

// Whether the segment is there and begins with a record of at most that number. Where its beginning
// is damaged the next one tells.
Result<bool> begins_by(const std::string& folder, std::uint32_t segment, std::uint64_t number) {
  for (;; ++segment) {
    Result<std::unique_ptr<SegmentWalk>> there = walk(folder, segment);
    if (!there.ok()) return there.error();
    if (!*there) return false;
    const Result<std::optional<RecordHeader>> first = (*there)->next(0);
    if (!first.ok()) return first.error();
    if (*first) return (*first)->number <= number;
    if ((*there)->message().empty()) return false;  // nothing is in it yet
  }
}

// The last segment that begins by that number. 0 also where none does.
Result<std::uint32_t> segment_of(const std::string& folder, std::uint64_t number) {
  std::uint32_t low = 0, high = 1;
  for (;; low = high, high *= 2) {
    const Result<bool> by = begins_by(folder, high, number);
    if (!by.ok()) return by.error();
    if (!*by) break;
  }
  while (high - low > 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    const Result<bool> by = begins_by(folder, middle, number);
    if (!by.ok()) return by.error();
    (*by ? low : high) = middle;
  }
  return low;
}

}  // namespace

Result<LogRecord> read_log_record(const std::string& folder, std::uint64_t number) {
  const Result<std::uint32_t> found = segment_of(folder, number);
  if (!found.ok()) return found.error();
  // Where it is not in that segment the beginning of the next one may be damaged, which says so.
  for (const std::uint32_t segment : {*found, *found + 1}) {
    Result<std::unique_ptr<SegmentWalk>> records = walk(folder, segment);
    if (!records.ok()) return records.error();
    if (!*records && segment == 0) return no_log(folder);
    while (*records) {
      const Result<std::optional<RecordHeader>> header = (*records)->next(0);
      if (!header.ok()) return header.error();
      if (*header && (*header)->number == number) return (*records)->read();
      if (*header && (*header)->number < number) continue;
      if (!*header && !(*records)->message().empty())
        return Error{ErrorCode::kCorruptData, (*records)->message()};
      break;
    }
  }
  return Error{ErrorCode::kNotFound, "the frame log ends before record " + std::to_string(number)};
}

Status visit_log_records(const std::string& folder, std::size_t beginning_bytes,
                         const std::function<void(const LogRecordHead&)>& visit) {
  for (std::uint32_t segment = 0;; ++segment) {
    Result<std::unique_ptr<SegmentWalk>> records = walk(folder, segment);
    if (!records.ok()) return records.error();
    if (!*records && segment == 0) return no_log(folder);
    if (!*records) return Done{};
    for (;;) {
      const Result<std::optional<RecordHeader>> header = (*records)->next(beginning_bytes);
      if (!header.ok()) return header.error();
      if (!*header) break;
      visit({(*header)->type, (*header)->number, (*records)->beginning(),
             [&records] { return (*records)->read(); }});
    }
  }
}

}  // namespace hermite::frame_log
