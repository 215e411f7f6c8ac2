// Keeps in memory what measuring needs of the scans that were last measured in, since a user
// usually measures several times in a scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/measure/measure.h"
#include "server/store/blobs.h"

namespace hermite::server {

// Thread-safe. Reads a scan again if its files have been put again (Blobs::version). Returns
// nothing for a removed scan.
class MeasuringCache {
 public:
  static constexpr std::size_t kMostScans = 4;
  // Surfels of all scans together.
  static constexpr std::uint64_t kMost_bytes = std::uint64_t{128} << 20;

  explicit MeasuringCache(std::uint64_t most_bytes = kMost_bytes) : most_bytes_(most_bytes) {}

  // May read for some seconds. `surfels_name` is the name of a cloud of the scan. If it has more
  // surfels than may be kept, none are, and they are read from `blobs`, which outlives the result,
  // each time they are iterated over. kNotFound: the scan lacks the files; kTooLarge, kIo, and
  // kCorruptData as map_knowledge_of and for_each_ply_point.
  Result<std::shared_ptr<const measure::MeasuredResult>> of(Blobs& blobs,
                                                            const std::string& scan_id,
                                                            const std::string& surfels_name);

  void forget(const std::string& scan_id);

  std::uint64_t kept_bytes() const;

 private:
  struct Entry {
    std::string scan_id, version;  // `version`: of all its files
    std::uint64_t bytes = 0;
    std::shared_ptr<const measure::MeasuredResult> result;
  };

  std::shared_ptr<const measure::MeasuredResult> found(const std::string& scan_id,
                                                       const std::string& version);
  void keep(Entry entry);

  const std::uint64_t most_bytes_;
  mutable std::mutex mutex_;
  std::vector<Entry> entries_;  // ordered by last use, the most recent one last
};

}  // namespace hermite::server
