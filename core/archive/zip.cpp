#include "core/archive/zip.h"

#include <archive.h>
#include <archive_entry.h>

#include <cstdint>
#include <memory>

namespace hermite::archive {

namespace {

// Greatest size without Zip64, which not everything reads.
constexpr std::uint64_t kMaxZip_bytes = (std::uint64_t{1} << 32) - 1;
// Overhead of an entry, at most: two headers and its name twice.
constexpr std::uint64_t kOverhead_bytes = 1024;

using Writer = std::unique_ptr<struct archive, decltype(&archive_write_free)>;
using Entry = std::unique_ptr<struct archive_entry, decltype(&archive_entry_free)>;

la_ssize_t append(struct archive*, void* bytes, const void* data, std::size_t size) {
  static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), size);
  return static_cast<la_ssize_t>(size);
}

}  // namespace

Result<std::string> format_zip(const ZipEntries& entries) {
  std::uint64_t size_bytes = 0;
  for (const auto& [name, bytes] : entries) size_bytes += bytes.size() + kOverhead_bytes;
  if (size_bytes > kMaxZip_bytes)
    return Error{ErrorCode::kTooLarge, "the files take more than the 4 GiB of a .zip"};
  std::string zip;
  zip.reserve(size_bytes);
  const Writer writer(archive_write_new(), archive_write_free);
  const auto failed = [&writer] {
    const char* const message = archive_error_string(writer.get());
    return Error{ErrorCode::kIo,
                 std::string("packing a .zip: ") + (message ? message : "out of memory")};
  };
  bool well = archive_write_set_format_zip(writer.get()) == ARCHIVE_OK &&
              archive_write_zip_set_compression_store(writer.get()) == ARCHIVE_OK &&
              archive_write_open(writer.get(), &zip, nullptr, append, nullptr) == ARCHIVE_OK;
  for (const auto& [name, bytes] : entries) {
    if (!well) return failed();
    const Entry entry(archive_entry_new(), archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_mtime(entry.get(), 0, 0);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
    well = archive_write_header(writer.get(), entry.get()) == ARCHIVE_OK &&
           archive_write_data(writer.get(), bytes.data(), bytes.size()) ==
               static_cast<la_ssize_t>(bytes.size());
  }
  if (!well || archive_write_close(writer.get()) != ARCHIVE_OK) return failed();
  return zip;
}

}  // namespace hermite::archive
