#include "server/result_files.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/dataset/byte_file.h"
#include "core/dataset/text_file.h"

namespace hermite::commands {

Result<ResultFiles> read_result_files(const std::string& folder) {
  Result<std::string> trajectory = dataset::read_text_file(folder + "/trajectory.txt");
  if (!trajectory.ok()) return trajectory.error();
  Result<std::string> report = dataset::read_text_file(folder + "/report.json");
  if (!report.ok()) return report.error();
  Result<dataset::ByteFile> surfels = dataset::ByteFile::open(folder + "/surfels.ply");
  if (!surfels.ok()) return surfels.error();
  const auto file = std::make_shared<const dataset::ByteFile>(*std::move(surfels));
  return ResultFiles{*std::move(trajectory), *std::move(report),
                     [file](std::uint64_t offset, std::size_t max_bytes) -> Result<std::string> {
                       if (offset >= file->bytes()) return std::string();
                       std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(
                                             max_bytes, file->bytes() - offset)),
                                         '\0');
                       const Status read = file->read_into(offset, bytes.data(), bytes.size());
                       if (!read.ok()) return read.error();
                       return bytes;
                     }};
}

}  // namespace hermite::commands
