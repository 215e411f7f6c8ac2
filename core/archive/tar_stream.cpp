#include "core/archive/tar_stream.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/archive/entry_name.h"
#include "core/archive/fresh_folder.h"
#include "core/archive/unpack.h"

namespace hermite::archive {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kBlock_bytes = 512;
constexpr std::int64_t kEnd_bytes = 2 * kBlock_bytes;                 // zeros
constexpr std::int64_t kMaxFile_bytes = (std::int64_t{1} << 33) - 1;  // 11 octal digits
constexpr std::size_t kMaxName_bytes = 100, kMaxPrefix_bytes = 155;

std::int64_t padded(std::int64_t bytes) {
  return (bytes + kBlock_bytes - 1) / kBlock_bytes * kBlock_bytes;
}

// A name may be split at a slash: nothing when no slash is in the right place.
Result<std::string> ustar_header(const std::string& name, std::int64_t size_bytes) {
  std::size_t split = 0;
  if (name.size() > kMaxName_bytes) {
    split = name.find('/', name.size() - kMaxName_bytes - 1);
    if (split == std::string::npos || split > kMaxPrefix_bytes)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("the name {} is too long for a tar: pack the folder yourself",
                               shown_entry_name(name))};
  }
  std::string header(kBlock_bytes, '\0');
  const auto put = [&header](std::size_t at, const std::string& text) {
    header.replace(at, text.size(), text);
  };
  char size[16];
  std::snprintf(size, sizeof size, "%011llo", static_cast<unsigned long long>(size_bytes));
  put(0, split == 0 ? name : name.substr(split + 1));
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  put(124, size);
  put(136, "00000000000");
  put(148, "        ");
  put(156, "0");
  put(257, std::string("ustar\0"
                       "00",
                       8));
  put(345, name.substr(0, split));
  unsigned int sum = 0;
  for (const char byte : header) sum += static_cast<unsigned char>(byte);
  char checksum[8];
  std::snprintf(checksum, sizeof checksum, "%06o", sum);
  put(148, std::string(checksum, 7) + ' ');
  return header;
}

Status read_at(const std::string& path, std::int64_t offset, std::int64_t expected_bytes, char* to,
               std::int64_t count) {
  const Error changed{ErrorCode::kIo, path + " has changed since it was looked at"};
  const OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (file.descriptor() < 0 || fstat(file.descriptor(), &status) != 0)
    return Error{ErrorCode::kIo, fmt::format("reading {}: {}", path, std::strerror(errno))};
  if (status.st_size != expected_bytes) return changed;
  while (count > 0) {
    const ssize_t got = pread(file.descriptor(), to, static_cast<std::size_t>(count), offset);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      return Error{ErrorCode::kIo, fmt::format("reading {}: {}", path, std::strerror(errno))};
    if (got == 0) return changed;
    to += got;
    offset += got;
    count -= got;
  }
  return Done{};
}

// Relative to `folder`, sorted.
Result<std::vector<fs::path>> files_below(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    std::error_code gone;
    if (entry->is_symlink(gone) || !entry->is_regular_file(gone)) continue;
    if (static_cast<std::int64_t>(files.size()) == UnpackLimits().entry_count)
      return Error{ErrorCode::kTooLarge, fmt::format("{} has more than {} files", folder.string(),
                                                     UnpackLimits().entry_count)};
    files.push_back(entry->path().lexically_relative(folder));
  }
  if (error)
    return Error{ErrorCode::kIo,
                 fmt::format("reading the folder {}: {}", folder.string(), error.message())};
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Result<TarStream> TarStream::open(const std::string& folder) {
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error || !fs::is_directory(root, error))
    return Error{ErrorCode::kNotFound, "there is no folder " + folder};
  const Result<std::vector<fs::path>> files = files_below(root);
  if (!files.ok()) return files.error();
  TarStream stream;
  for (const fs::path& file : *files)
    if (const Status added = stream.add((root / file).string(), (root.filename() / file).string());
        !added.ok())
      return added.error();
  stream.size_bytes_ += kEnd_bytes;
  return stream;
}

Status TarStream::add(const std::string& path, const std::string& name) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0)
    return Error{ErrorCode::kIo, fmt::format("reading {}: {}", path, std::strerror(errno))};
  if (const auto parts = safe_entry_parts(name); !parts.ok())
    return in_context(path, parts.error());
  if (status.st_size > kMaxFile_bytes)
    return Error{ErrorCode::kTooLarge, path + " has 8 GiB or more: pack the folder yourself"};
  Result<std::string> header = ustar_header(name, status.st_size);
  if (!header.ok()) return header.error();
  members_.push_back({path, *std::move(header), size_bytes_, status.st_size});
  size_bytes_ += kBlock_bytes + padded(status.st_size);
  fingerprint_ += fmt::format("{} {} {}.{}\n", name, status.st_size, status.st_mtim.tv_sec,
                              status.st_mtim.tv_nsec);
  return Done{};
}

Result<std::string> TarStream::read(std::int64_t offset, std::int64_t count) const {
  count = std::clamp<std::int64_t>(count, 0, std::max<std::int64_t>(0, size_bytes_ - offset));
  const std::int64_t end = offset + count;
  std::string bytes(static_cast<std::size_t>(count), '\0');  // padding and end are zeros
  auto member = std::upper_bound(
      members_.begin(), members_.end(), offset,
      [](std::int64_t at, const Member& candidate) { return at < candidate.begin; });
  if (member != members_.begin()) --member;
  for (; member != members_.end() && member->begin < end; ++member) {
    const std::int64_t contents = member->begin + kBlock_bytes;
    const std::int64_t header_from = std::max(offset, member->begin),
                       header_to = std::min(end, contents);
    if (header_from < header_to)
      bytes.replace(static_cast<std::size_t>(header_from - offset),
                    static_cast<std::size_t>(header_to - header_from), member->header,
                    static_cast<std::size_t>(header_from - member->begin),
                    static_cast<std::size_t>(header_to - header_from));
    const std::int64_t from = std::max(offset, contents),
                       to = std::min(end, contents + member->size_bytes);
    if (from >= to) continue;
    if (Status status = read_at(member->path, from - contents, member->size_bytes,
                                bytes.data() + (from - offset), to - from);
        !status.ok())
      return status.error();
  }
  return bytes;
}

}  // namespace hermite::archive
