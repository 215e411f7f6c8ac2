#include "core/archive/unpack.h"

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/archive/entry_name.h"
#include "core/archive/fresh_folder.h"
#include "core/archive/zip_directory.h"

namespace hermite::archive {
namespace {

constexpr std::size_t kReadBlock_bytes = 64 << 10;
constexpr std::size_t kTarBlock_bytes = 512;
// The question takes microseconds. What must stay free is far more than some archives write between
// two.
constexpr std::uint64_t kInodesBetweenQuestions = 64, kBytesBetweenQuestions = 4 << 20;
// A name at least, which no zip goes without: with 128 bytes an entry the directory of the most
// entries allowed takes 26 MB.
constexpr std::int64_t kZipDirectorySlack = 3;

using Bytes = std::span<const std::uint8_t>;

struct Magic {
  const char* kind;
  std::size_t offset;
  std::string_view bytes;
};

// gzip with its only method, so that a klg of 35 615 frames is none.
constexpr Magic kMagics[] = {
    {"zip", 0, std::string_view("PK\3\4", 4)},
    {"zip", 0, std::string_view("PK\5\6", 4)},
    {"gzip", 0, std::string_view("\x1f\x8b\x08", 3)},
    {"zstd", 0, std::string_view("\x28\xb5\x2f\xfd", 4)},
    {"tar", 257, std::string_view("ustar", 5)},
};
// What we do not unpack, but do not let pass inside an archive either.
constexpr Magic kForeignMagics[] = {
    {"xz", 0,
     std::string_view("\xfd"
                      "7zXZ\0",
                      6)},
    {"bzip2", 0, std::string_view("BZh", 3)},
    {"7z", 0, std::string_view("7z\xbc\xaf\x27\x1c", 6)},
    {"rar", 0, std::string_view("Rar!\x1a\x07", 6)},
};

const char* archive_kind(Bytes bytes, std::span<const Magic> magics) {
  for (const Magic& magic : magics) {
    if (bytes.size() < magic.offset + magic.bytes.size()) continue;
    if (std::memcmp(bytes.data() + magic.offset, magic.bytes.data(), magic.bytes.size()) == 0)
      return magic.kind;
  }
  return nullptr;
}

struct Source {
  OpenFile file;
  std::int64_t bytes = 0;
  const char* kind = nullptr;  // none: no archive
};

Result<Source> open_source(const std::string& path) {
  Source source{OpenFile(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)), 0, nullptr};
  if (source.file.descriptor() < 0)
    return Error{errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo,
                 fmt::format("cannot read {}: {}", path, std::strerror(errno))};
  struct stat status {};
  if (fstat(source.file.descriptor(), &status) != 0 || !S_ISREG(status.st_mode))
    return Error{ErrorCode::kIo, path + " is not a file"};
  source.bytes = status.st_size;
  std::array<std::uint8_t, kTarBlock_bytes> start{};
  const ssize_t count = pread(source.file.descriptor(), start.data(), start.size(), 0);
  if (count < 0)
    return Error{ErrorCode::kIo, fmt::format("cannot read {}: {}", path, std::strerror(errno))};
  source.kind = archive_kind(Bytes(start).first(static_cast<std::size_t>(count)), kMagics);
  return source;
}

// Every tar ends with blocks of zeros: without them it was cut between two entries, which
// libarchive does not mind.
Status check_tar_end(const Source& source) {
  std::array<std::uint8_t, kTarBlock_bytes> end{};
  const bool whole =
      source.bytes >= static_cast<std::int64_t>(end.size()) &&
      pread(source.file.descriptor(), end.data(), end.size(),
            source.bytes - static_cast<std::int64_t>(end.size())) ==
          static_cast<ssize_t>(end.size()) &&
      std::all_of(end.begin(), end.end(), [](std::uint8_t byte) { return byte == 0; });
  if (!whole) return Error{ErrorCode::kCorruptData, "the tar does not end as tars do: cut short"};
  return Done{};
}

Status check_zip(const Source& source, const UnpackLimits& limits) {
  const Result<std::int64_t> entries = max_zip_entries(source.file.descriptor(), source.bytes);
  if (!entries.ok()) return entries.error();
  if (*entries > kZipDirectorySlack * limits.entry_count + kZipDirectorySlack)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("the zip's directory has room for {} entries, allowed are {}",
                             *entries, limits.entry_count)};
  return Done{};
}

struct Release {
  void operator()(::archive* reader) const { archive_read_free(reader); }
};
using Reader = std::unique_ptr<::archive, Release>;

Error archive_error(const Reader& reader) {
  const char* message = archive_error_string(reader.get());
  return {ErrorCode::kCorruptData, message != nullptr ? message : "damaged"};
}

// One format and one filter only, those that the first bytes name.
Result<Reader> open_reader(const Source& source) {
  Reader reader(archive_read_new());
  if (!reader) throw std::bad_alloc();
  const std::string_view kind = source.kind;
  int status = kind == "zip" ? archive_read_support_format_zip(reader.get())
                             : archive_read_support_format_tar(reader.get());
  if (status == ARCHIVE_OK && kind == "gzip")
    status = archive_read_support_filter_gzip(reader.get());
  if (status == ARCHIVE_OK && kind == "zstd")
    status = archive_read_support_filter_zstd(reader.get());
  // A warning would mean that another program has to decompress.
  if (status != ARCHIVE_OK)
    return Error{ErrorCode::kUnsupported,
                 "this build of libarchive does not read " + std::string(kind)};
  if (archive_read_open_fd(reader.get(), source.file.descriptor(), kReadBlock_bytes) != ARCHIVE_OK)
    return archive_error(reader);
  return reader;
}

const char* refused_type(archive_entry* entry) {
  if (archive_entry_hardlink(entry) != nullptr) return "a hard link";
  switch (archive_entry_filetype(entry)) {
    case AE_IFREG: break;
    case AE_IFDIR: return nullptr;
    case AE_IFLNK: return "a symbolic link";
    case AE_IFCHR: return "a character device";
    case AE_IFBLK: return "a block device";
    case AE_IFIFO: return "a FIFO";
    case AE_IFSOCK: return "a socket";
    default: return "no file";
  }
  if (archive_entry_sparse_count(entry) > 0) return "a sparse file";
  if (archive_entry_is_encrypted(entry) != 0) return "encrypted";
  return nullptr;
}

std::string megabytes(std::uint64_t bytes) { return std::to_string(bytes / 1'000'000) + " MB"; }

class Unpacking {
 public:
  Unpacking(Reader reader, const FreshFolder& folder, const UnpackLimits& limits,
            std::uint64_t packed_bytes, const UnpackWatch& watch)
      : reader_(std::move(reader)),
        folder_(folder),
        limits_(limits),
        packed_bytes_(packed_bytes),
        watch_(watch),
        buffer_(kReadBlock_bytes) {}

  Result<UnpackSummary> run() {
    for (std::int64_t entry_count = 0;; ++entry_count) {
      archive_entry* entry = nullptr;
      const int status = archive_read_next_header(reader_.get(), &entry);
      if (status == ARCHIVE_EOF) return lacks_room() ? Result<UnpackSummary>(no_room()) : summary_;
      if (status < ARCHIVE_WARN) return archive_error(reader_);
      // "None" counts as one.
      if (archive_filter_count(reader_.get()) > 2)
        return Error{ErrorCode::kInvalidArgument, "it is compressed more than once"};
      if (entry_count == limits_.entry_count)
        return Error{ErrorCode::kTooLarge,
                     fmt::format("more than {} entries", limits_.entry_count)};
      const char* name = archive_entry_pathname(entry);
      if (name == nullptr) name = archive_entry_pathname_utf8(entry);
      if (name == nullptr)
        return Error{ErrorCode::kInvalidArgument,
                     fmt::format("entry {} has a name that is no text", entry_count)};
      const std::string shown = shown_entry_name(name);
      if (const Status done = unpack(entry, name); !done.ok())
        return in_context(fmt::format("entry \"{}\"", shown), done.error());
    }
  }

 private:
  Status unpack(archive_entry* entry, std::string_view name) {
    const Result<std::vector<std::string>> parts = safe_entry_parts(name);
    if (!parts.ok()) return parts.error();
    if (const char* refused = refused_type(entry))
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("is {}; only regular files are unpacked", refused)};
    const bool is_folder = archive_entry_filetype(entry) == AE_IFDIR;
    count_inodes(parts->size());
    if (is_folder) return lacks_room() ? Status(Done{}) : folder_.make_folder(*parts);
    if (parts->empty()) return Error{ErrorCode::kInvalidArgument, "is a file without a name"};
    if (static_cast<std::uint64_t>(++summary_.file_count) > limits_.capacity_inodes)
      return Error{
          ErrorCode::kTooLarge,
          fmt::format("it has more files than the {} inodes that the disk could have room for",
                      limits_.capacity_inodes)};
    if (lacks_room()) return read_contents(nullptr);
    const Result<OpenFile> file = folder_.create(*parts);
    return file.ok() ? read_contents(&*file) : file.error();
  }

  // No fewer than it takes.
  void count_inodes(std::size_t count) {
    const bool had_room = !lacks_room();
    inode_count_ += count;
    ask_for_room();
    if (had_room && lacks_room()) folder_.clear();  // others want the room meanwhile
  }

  // Others write to the same disk, other archives for example.
  void ask_for_room() {
    if (!limits_.has_room_left || lacks_room()) return;
    if (inode_count_ < asked_at_inodes_ + kInodesBetweenQuestions &&
        summary_.output_bytes < asked_at_bytes_ + kBytesBetweenQuestions)
      return;
    asked_at_inodes_ = inode_count_;
    asked_at_bytes_ = summary_.output_bytes;
    others_need_room_ = !limits_.has_room_left();
  }

  bool lacks_room() const {
    return others_need_room_ || summary_.output_bytes > limits_.room_bytes ||
           inode_count_ > limits_.room_inodes;
  }
  Error no_room() const {
    if (others_need_room_)
      return {ErrorCode::kBusy,
              "the disk has no room for it now: others have taken some while it was unpacked"};
    if (inode_count_ > limits_.room_inodes)
      return {
          ErrorCode::kBusy,
          fmt::format("it has up to {} files and folders, the disk has room for {} (inodes) now",
                      inode_count_, limits_.room_inodes)};
    return {ErrorCode::kBusy,
            fmt::format("unpacked it has {}, the disk has room for {} now",
                        megabytes(summary_.output_bytes), megabytes(limits_.room_bytes))};
  }

  // Without a file the bytes are only counted.
  Status read_contents(const OpenFile* file) {
    for (bool first = true;; first = false) {
      const Result<std::size_t> filled = fill();
      if (!filled.ok()) return filled.error();
      if (*filled == 0) return Done{};
      const Bytes block = Bytes(buffer_).first(*filled);
      if (first)
        if (const Status status = check_not_nested(block); !status.ok()) return status;
      summary_.output_bytes += block.size();
      if (watch_ && !watch_(summary_.output_bytes))
        return Error{ErrorCode::kIo, "unpacking was stopped"};
      if (const Status status = check_output(); !status.ok()) return status;
      ask_for_room();
      if (file && lacks_room()) {
        folder_.clear();  // others want the room meanwhile
        file = nullptr;
      }
      if (!file) continue;
      if (const Status status = file->write(block); !status.ok()) return status;
    }
  }

  // As much of the entry as the buffer holds: less only at its end.
  Result<std::size_t> fill() {
    std::size_t filled = 0;
    while (filled < buffer_.size()) {
      const la_ssize_t count =
          archive_read_data(reader_.get(), buffer_.data() + filled, buffer_.size() - filled);
      if (count < 0) return archive_error(reader_);
      if (count == 0) break;
      filled += static_cast<std::size_t>(count);
    }
    return filled;
  }

  static Status check_not_nested(Bytes start) {
    const char* kind = archive_kind(start, kMagics);
    if (kind == nullptr) kind = archive_kind(start, kForeignMagics);
    if (kind == nullptr) return Done{};
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("is an archive ({}) inside the archive", kind)};
  }

  Status check_output() const {
    const std::uint64_t bytes = summary_.output_bytes;
    if (bytes > limits_.output_bytes)
      return Error{ErrorCode::kTooLarge,
                   fmt::format("unpacked it has more than {} bytes", limits_.output_bytes)};
    if (bytes > limits_.capacity_bytes)
      return Error{
          ErrorCode::kTooLarge,
          fmt::format("unpacked it has more than {}, all that the disk could have room for",
                      megabytes(limits_.capacity_bytes))};
    if (bytes > limits_.ratio_free_bytes && bytes / limits_.ratio > packed_bytes_)
      return Error{ErrorCode::kTooLarge,
                   fmt::format("unpacked it has more than {} times its {} bytes", limits_.ratio,
                               packed_bytes_)};
    return Done{};
  }

  const Reader reader_;
  const FreshFolder& folder_;
  const UnpackLimits limits_;
  const std::uint64_t packed_bytes_;
  const UnpackWatch& watch_;
  std::vector<std::uint8_t> buffer_;
  UnpackSummary summary_;
  std::uint64_t inode_count_ = 0;
  std::uint64_t asked_at_inodes_ = 0, asked_at_bytes_ = 0;
  bool others_need_room_ = false;
};

Result<UnpackSummary> unpack_source(const Source& source, const FreshFolder& folder,
                                    const UnpackLimits& limits, const UnpackWatch& watch) {
  const std::string_view kind = source.kind;
  const Status sound = kind == "tar"   ? check_tar_end(source)
                       : kind == "zip" ? check_zip(source, limits)
                                       : Status(Done{});
  if (!sound.ok()) return sound.error();
  Result<Reader> reader = open_reader(source);
  if (!reader.ok()) return reader.error();
  Result<UnpackSummary> summary =
      Unpacking(std::move(*reader), folder, limits, static_cast<std::uint64_t>(source.bytes), watch)
          .run();
  if (!summary.ok()) {
    folder.clear();
    return summary.error();
  }
  summary->kind = kind == "gzip" ? "tar.gz" : kind == "zstd" ? "tar.zst" : kind;
  return summary;
}

}  // namespace

bool is_archive(const std::string& path) {
  const Result<Source> source = open_source(path);
  return source.ok() && source->kind != nullptr;
}

Result<UnpackSummary> unpack_archive(const std::string& path, const std::string& folder,
                                     const UnpackLimits& limits, const UnpackWatch& watch) {
  const Result<Source> source = open_source(path);
  if (!source.ok()) return source.error();
  if (source->kind == nullptr)
    return Error{
        ErrorCode::kUnsupported,
        path + " is no archive: it begins neither as a zip nor as a tar, plain or in gzip or zstd"};
  const Result<FreshFolder> fresh = FreshFolder::open(folder);
  if (!fresh.ok()) return fresh.error();
  const Result<UnpackSummary> summary = unpack_source(*source, *fresh, limits, watch);
  if (!summary.ok()) return in_context(path, summary.error());
  return summary;
}

}  // namespace hermite::archive
