#include "core/log/log_segments.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/sync_path.h"

namespace hermite::frame_log {

namespace {

Error io_failure(const std::string& what) {
  return {ErrorCode::kIo, what + ": " + std::strerror(errno)};
}

}  // namespace

LogSegments::LogSegments(std::string folder, FrameLogOptions options)
    : folder_(std::filesystem::absolute(std::filesystem::path(folder) / "").parent_path()),
      options_(std::move(options)) {}

LogSegments::~LogSegments() {
  if (file_ >= 0) close(file_);
}

Status LogSegments::create() {
  if (mkdir(folder_.c_str(), 0700) != 0) return io_failure("creating " + folder_);
  const std::string scan_folder = std::filesystem::path(folder_).parent_path();
  const std::string scans_folder = std::filesystem::path(scan_folder).parent_path();
  if (Status status = sync_path(scan_folder); !status.ok()) return status;
  // The scan's folder may be new as well. A process that cannot read the folder of all scans has
  // not just created one in it.
  if (access(scans_folder.c_str(), R_OK) == 0)
    if (Status status = sync_path(scans_folder); !status.ok()) return status;
  return begin_segment(0);
}

Status LogSegments::begin_segment(std::uint32_t segment) {
  if (file_ >= 0) {
    if (Status status = sync(); !status.ok()) return status;
    close(file_);
  }
  const std::string path = folder_ + "/" + segment_name(segment);
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file_ < 0) return io_failure("creating " + path);
  segment_ = segment;
  offset_ = 0;
  if (Status status = write_all(format_segment_header(segment)); !status.ok()) return status;
  if (Status status = sync(); !status.ok()) return status;
  return sync_path(folder_);
}

Status LogSegments::remove_segments_after(std::uint32_t segment) {
  // Lists the folder instead of counting, because a gap must not hide segments after it.
  std::error_code error;
  std::vector<std::filesystem::path> later;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("segment-") && name > segment_name(segment)) later.push_back(entry.path());
  }
  for (const std::filesystem::path& path : later)
    if (!error) std::filesystem::remove(path, error);
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("removing the segments after the end of the log in {}: {}", folder_,
                             error.message())};
  return Done{};
}

Status LogSegments::continue_at(const LogEnd& end) {
  record_count_ = end.record_count;
  if (Status status = remove_segments_after(end.segment); !status.ok()) return status;
  const std::string path = folder_ + "/" + segment_name(end.segment);
  if (end.offset == 0) {
    if (unlink(path.c_str()) != 0) return io_failure("removing " + path);
    return begin_segment(end.segment);
  }
  file_ = open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW);
  if (file_ < 0) return io_failure("opening " + path);
  if (ftruncate(file_, static_cast<off_t>(end.offset)) != 0) return io_failure("cutting " + path);
  segment_ = end.segment;
  offset_ = end.offset;
  if (Status status = sync(); !status.ok()) return status;
  return sync_path(folder_);
}

Status LogSegments::append(RecordType type, std::string_view payload) {
  CHECK(payload.size() <= kMaxRecordBytes, "a record exceeds the size limit of the format");
  const std::uint64_t length = kRecordHeaderBytes + payload.size();
  if (offset_ > kSegmentHeaderBytes && offset_ + length > options_.segment_bytes)
    if (Status status = begin_segment(segment_ + 1); !status.ok()) return status;
  if (Status status = write_all(format_record_header(type, record_count_, payload)); !status.ok())
    return status;
  if (Status status = write_all(payload); !status.ok()) return status;
  ++record_count_;
  return Done{};
}

Status LogSegments::sync() {
  if (options_.sync(file_) != 0)
    return io_failure(fmt::format("syncing {}/{}", folder_, segment_name(segment_)));
  return Done{};
}

Status LogSegments::write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = options_.write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0)
      return io_failure(fmt::format("writing {}/{}", folder_, segment_name(segment_)));
    bytes.remove_prefix(static_cast<std::size_t>(count));
    offset_ += static_cast<std::uint64_t>(count);
  }
  return Done{};
}

}  // namespace hermite::frame_log
