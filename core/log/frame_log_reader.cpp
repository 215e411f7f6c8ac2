#include "core/log/frame_log_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace hermite {

namespace {

Error read_failure(const std::string& what) { return {ErrorCode::kIo, what + ": " + std::strerror(errno)}; }

}  // namespace

struct FrameLogReader::File {
  const std::string path;
  const int descriptor;
  std::uint64_t offset = 0, size = 0;  // bytes; the size at the last query

  File(std::string file_path, int opened) : path(std::move(file_path)), descriptor(opened) {}
  ~File() { close(descriptor); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  Status ask_size() {
    struct stat status {};
    if (fstat(descriptor, &status) != 0) return read_failure("asking for the size of " + path);
    size = static_cast<std::uint64_t>(status.st_size);
    return Done{};
  }

  // Returns the available bytes, at most `count`.
  Result<std::string> read(std::size_t count) {
    if (count > size - offset)
      if (Status status = ask_size(); !status.ok()) return status.error();
    std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(count, size - offset)), '\0');
    for (std::size_t have = 0; have < bytes.size();) {
      const ssize_t got = ::read(descriptor, bytes.data() + have, bytes.size() - have);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return read_failure("reading " + path);
      if (got == 0) bytes.resize(have);
      have += static_cast<std::size_t>(got);
    }
    offset += bytes.size();
    return bytes;
  }
};

FrameLogReader::FrameLogReader(std::string folder) : folder_(std::move(folder)) {}
FrameLogReader::~FrameLogReader() = default;

std::optional<LogRecord> FrameLogReader::stop(std::string words) {
  stopped_ = true;
  end_.words = std::move(words);
  return std::nullopt;
}

// Returns false when there is no such segment.
Result<bool> FrameLogReader::open_segment(std::uint32_t segment) {
  file_.reset();
  const std::string path = folder_ + "/" + segment_name(segment);
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0 && errno == ENOENT) return false;
  if (descriptor < 0) return read_failure("opening " + path);
  file_ = std::make_unique<File>(path, descriptor);
  if (Status status = file_->ask_size(); !status.ok()) return status.error();
  return true;
}

Result<std::optional<LogRecord>> FrameLogReader::next() {
  if (stopped_) return std::optional<LogRecord>();
  if (file_ && file_->offset == file_->size)
    if (Status status = file_->ask_size(); !status.ok()) return status.error();
  if (!file_ || file_->offset == file_->size) {
    const std::uint32_t segment = file_ ? end_.segment + 1 : 0;
    const Result<bool> there = open_segment(segment);
    if (!there.ok()) return there.error();
    if (!*there && segment == 0) return Error{ErrorCode::kNotFound, "there is no frame log in " + folder_};
    if (!*there) return stop("");
    end_.segment = segment;
    end_.offset = 0;
    const Result<std::string> header = file_->read(kSegmentHeaderBytes);
    if (!header.ok()) return header.error();
    if (*header != format_segment_header(segment)) return stop(segment_name(segment) + " has no valid header");
    end_.offset = file_->offset;
    if (file_->offset == file_->size) return next();
  }
  const Result<std::string> bytes = file_->read(kRecordHeaderBytes);
  if (!bytes.ok()) return bytes.error();
  const std::string where = segment_name(end_.segment) + " at byte " + std::to_string(end_.offset);
  const std::optional<RecordHeader> header = parse_record_header(*bytes);
  if (!header) return stop(where + ": there is no valid record header");
  if (header->number != end_.record_count)
    return stop(where + ": found record " + std::to_string(header->number) + " instead of " + std::to_string(end_.record_count));
  Result<std::string> payload = file_->read(header->length);
  if (!payload.ok()) return payload.error();
  if (payload->size() != header->length) return stop(where + ": cut within a record");
  if (!crc_fits(*bytes, *payload)) return stop(where + ": the checksum does not match");
  end_.offset = file_->offset;
  ++end_.record_count;
  return std::optional<LogRecord>(LogRecord{header->type, header->number, *std::move(payload)});
}

}  // namespace hermite
