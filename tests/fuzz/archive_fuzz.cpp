// Archives. Input: the archive. Nothing but files and folders may appear, and only in the folder.
#include <filesystem>

#include "core/archive/fresh_folder.h"
#include "core/archive/unpack.h"
#include "tests/fuzz/recording_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hermite;
  namespace fs = std::filesystem;
  const fuzz::MemoryFile file(data, size);
  const Result<archive::TemporaryFolder> folder = archive::TemporaryFolder::make();
  CHECK(folder.ok(), "no temporary folder");
  archive::UnpackLimits limits;
  limits.output_bytes = 1 << 20;  // so that a bomb takes no time
  limits.entry_count = 100;
  const std::string inside = folder->path() + "/inside";
  const Result<archive::UnpackSummary> summary =
      archive::unpack_archive(file.path(), inside, limits);
  CHECK(summary.ok() || !fs::exists(inside) || fs::is_empty(inside),
        "something is left of a refused archive");
  CHECK(summary.ok() || !summary.error().message.empty(), "an error without words");
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder->path())) {
    CHECK(!entry.is_symlink() && (entry.is_regular_file() || entry.is_directory()),
          "neither a file nor a folder");
    CHECK(entry.path().string().starts_with(inside), "outside of the folder");
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  CHECK(bytes <= limits.output_bytes, "more bytes than allowed");
  return 0;
}
