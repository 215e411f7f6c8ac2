#include "core/output/ply.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "core/base/sync_path.h"
#include "core/output/ply_points.h"

namespace hermite::output {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are written in the byte order of the CPU");

constexpr const char* kProperties =
    "property float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property float confidence\nproperty float curvature_max\nproperty float "
    "curvature_min\nproperty float radius\n"
    "property uint submap\n";
constexpr std::size_t kVertex_bytes =
    6 * sizeof(float) + sizeof(Rgb8) + 4 * sizeof(float) + sizeof(std::uint32_t);

template <class... Values>
void append(std::string& bytes, const Values&... values) {
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
}

Error io_error(const std::string& what, const std::string& path) {
  return {ErrorCode::kIo,
          fmt::format("cannot {} {}: {}", what, path, std::generic_category().message(errno))};
}

std::string header_of(std::uint64_t count) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\n"
      "comment Hermite: metres, 1/metres, normals towards the camera\n"
      "element vertex {}\n{}end_header\n",
      count, kProperties);
}

template <class Value>
void take(const char*& at, Value& value) {
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
}

CloudPoint point_at(const char* at) {
  CloudPoint point;
  for (int axis = 0; axis < 3; ++axis) take(at, point.position_m[axis]);
  for (int axis = 0; axis < 3; ++axis) take(at, point.normal[axis]);
  take(at, point.color);
  take(at, point.confidence);
  take(at, point.curvature_max_per_m);
  take(at, point.curvature_min_per_m);
  take(at, point.radius_m);
  take(at, point.submap);
  return point;
}

class FileDescriptor {
 public:
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  ~FileDescriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;

  int get() const { return descriptor_; }
  bool valid() const { return descriptor_ >= 0; }
  bool close() { return ::close(std::exchange(descriptor_, -1)) == 0; }

 private:
  int descriptor_;
};

bool write_all(int descriptor, const std::string& bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(descriptor, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    written += static_cast<std::size_t>(count);
  }
  return true;
}

Status write_and_sync(const std::string& path, const std::string& bytes) {
  FileDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!file.valid()) return io_error("create", path);
  if (!write_all(file.get(), bytes)) return io_error("write", path);
  if (::fsync(file.get()) != 0) return io_error("sync", path);
  if (!file.close()) return io_error("close", path);
  return Done{};
}

}  // namespace

std::string format_ply(const Cloud& cloud) {
  std::string bytes = header_of(cloud.size());
  bytes.reserve(bytes.size() + cloud.size() * kVertex_bytes);
  for (const CloudPoint& point : cloud) {
    append(bytes, point.position_m.x(), point.position_m.y(), point.position_m.z(),
           point.normal.x(), point.normal.y(), point.normal.z());
    append(bytes, point.color.r, point.color.g, point.color.b);
    append(bytes, point.confidence, point.curvature_max_per_m, point.curvature_min_per_m,
           point.radius_m, point.submap);
  }
  return bytes;
}

Status for_each_ply_point(const ReadPart& read, const std::function<void(const CloudPoint&)>& use) {
  constexpr std::size_t kPieceVertices = 65536;
  static const std::string kBeforeCount = header_of(0).substr(0, header_of(0).find("vertex ") + 7);
  Result<std::string> head = read(0, header_of(std::numeric_limits<std::uint64_t>::max()).size());
  if (!head.ok()) return head.error();
  const bool begins_well = head->starts_with(kBeforeCount);
  const std::uint64_t count =
      begins_well ? std::strtoull(head->c_str() + kBeforeCount.size(), nullptr, 10) : 0;
  const std::string header = header_of(count);
  if (!begins_well || !head->starts_with(header))
    return Error{ErrorCode::kUnsupported, "the file is not a cloud written by Hermite"};
  for (std::uint64_t i = 0; i < count;) {
    const std::size_t wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(kPieceVertices, count - i));
    const Result<std::string> piece =
        read(header.size() + i * kVertex_bytes, wanted * kVertex_bytes);
    if (!piece.ok()) return piece.error();
    if (piece->size() < wanted * kVertex_bytes)
      return Error{ErrorCode::kCorruptData,
                   "the cloud is cut: it has fewer points than its header states"};
    for (std::size_t k = 0; k < wanted; ++k) use(point_at(piece->data() + k * kVertex_bytes));
    i += wanted;
  }
  return Done{};
}

Status write_file_atomically(const std::string& path, const std::string& bytes) {
  // So that two threads never use the same temporary file.
  static std::atomic<std::uint64_t> count = 0;
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "."
                             : slash == 0               ? "/"
                                                        : path.substr(0, slash);
  const std::string temporary = fmt::format("{}.{}-{}.tmp", path, ::getpid(), count++);

  if (const Status written = write_and_sync(temporary, bytes); !written.ok()) {
    ::unlink(temporary.c_str());
    return written.error();
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    const Error error = io_error(fmt::format("rename {} to", temporary), path);
    ::unlink(temporary.c_str());
    return error;
  }
  return sync_path(folder);
}

}  // namespace hermite::output
