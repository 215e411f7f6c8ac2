#include "core/log/frame_log_reader.h"

#include <fmt/core.h>

#include <utility>

#include "core/log/segment_file.h"

namespace hermite::frame_log {

FrameLogReader::FrameLogReader(std::string folder) : folder_(std::move(folder)) {}
FrameLogReader::~FrameLogReader() = default;

std::optional<LogRecord> FrameLogReader::stop(std::string message) {
  stopped_ = true;
  end_.message = std::move(message);
  return std::nullopt;
}

// Returns false when there is no such segment.
Result<bool> FrameLogReader::open_segment(std::uint32_t segment) {
  Result<std::unique_ptr<SegmentFile>> file = SegmentFile::open(folder_, segment);
  if (!file.ok()) return file.error();
  file_ = *std::move(file);
  return file_ != nullptr;
}

Result<std::optional<LogRecord>> FrameLogReader::next() {
  if (stopped_) return std::optional<LogRecord>();
  if (file_ && end_.offset == file_->size_bytes())
    if (Status status = file_->ask_size(); !status.ok()) return status.error();
  if (!file_ || end_.offset == file_->size_bytes()) {
    const std::uint32_t segment = file_ ? end_.segment + 1 : 0;
    const Result<bool> there = open_segment(segment);
    if (!there.ok()) return there.error();
    if (!*there && segment == 0)
      return Error{ErrorCode::kNotFound, "there is no frame log in " + folder_};
    if (!*there) return stop("");
    end_.segment = segment;
    end_.offset = 0;
    const Result<std::string> header = file_->read(0, kSegmentHeaderBytes);
    if (!header.ok()) return header.error();
    if (*header != format_segment_header(segment))
      return stop(segment_name(segment) + " has no valid header");
    end_.offset = kSegmentHeaderBytes;
    if (end_.offset == file_->size_bytes()) return next();
  }
  const Result<std::string> bytes = file_->read(end_.offset, kRecordHeaderBytes);
  if (!bytes.ok()) return bytes.error();
  const std::string where = fmt::format("{} at byte {}", segment_name(end_.segment), end_.offset);
  const std::optional<RecordHeader> header = parse_record_header(*bytes);
  if (!header) return stop(where + ": there is no valid record header");
  if (header->number != end_.record_count)
    return stop(
        fmt::format("{}: found record {} instead of {}", where, header->number, end_.record_count));
  Result<std::string> payload = file_->read(end_.offset + kRecordHeaderBytes, header->length);
  if (!payload.ok()) return payload.error();
  if (payload->size() != header->length) return stop(where + ": cut within a record");
  if (!crc_fits(*bytes, *payload)) return stop(where + ": the checksum does not match");
  end_.offset += kRecordHeaderBytes + header->length;
  ++end_.record_count;
  return std::optional<LogRecord>(LogRecord{header->type, header->number, *std::move(payload)});
}

}  // namespace hermite::frame_log
