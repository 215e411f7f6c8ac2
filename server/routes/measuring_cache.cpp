#include "server/routes/measuring_cache.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "core/output/ply_points.h"
#include "server/exports/result_sources.h"

namespace hermite::server {

namespace {

// Iterates over surfels that are not kept in memory.
measure::EachPoint reading_from(Blobs& blobs, const std::string& scan_id,
                                const std::string& surfels_name) {
  return
      [&blobs, scan_id, surfels_name](const std::function<void(const output::CloudPoint&)>& use) {
        return output::for_each_ply_point(
            [&](std::uint64_t offset, std::size_t max_bytes) {
              return blobs.read(scan_id, surfels_name, offset, max_bytes);
            },
            use);
      };
}

}  // namespace

Result<std::shared_ptr<const measure::MeasuredResult>> MeasuringCache::of(
    Blobs& blobs, const std::string& scan_id, const std::string& surfels_name) {
  std::string version;
  for (const std::string& name :
       {surfels_name, std::string(kTrajectoryFile), std::string(kReportFile)}) {
    const Result<std::string> one = blobs.version(scan_id, name);
    if (!one.ok()) return one.error();
    version += fmt::format("{} {}\n", name, *one);
  }
  if (std::shared_ptr<const measure::MeasuredResult> kept = found(scan_id, version)) return kept;
  Result<measure::MapKnowledge> map = read_map_knowledge(blobs, scan_id);
  if (!map.ok()) return map.error();
  const measure::EachPoint read = reading_from(blobs, scan_id, surfels_name);
  const auto cloud = std::make_shared<output::Cloud>();
  bool is_too_large = false;
  const Status whole = read([&](const output::CloudPoint& point) {
    is_too_large = is_too_large || (cloud->size() + 1) * sizeof(output::CloudPoint) > most_bytes_;
    if (!is_too_large) cloud->push_back(point);
  });
  if (!whole.ok()) return whole.error();
  if (is_too_large)
    return std::make_shared<const measure::MeasuredResult>(
        measure::MeasuredResult{read, *std::move(map)});
  cloud->shrink_to_fit();
  const measure::EachPoint each_point =
      [cloud = std::shared_ptr<const output::Cloud>(cloud)](
          const std::function<void(const output::CloudPoint&)>& use) -> Status {
    for (const output::CloudPoint& point : *cloud) use(point);
    return Done{};
  };
  auto result = std::make_shared<const measure::MeasuredResult>(
      measure::MeasuredResult{each_point, *std::move(map)});
  keep({scan_id, version, cloud->size() * sizeof(output::CloudPoint), result});
  return std::shared_ptr<const measure::MeasuredResult>(std::move(result));
}

void MeasuringCache::forget(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.scan_id == scan_id; });
}

std::uint64_t MeasuringCache::kept_bytes() const {
  const std::lock_guard lock(mutex_);
  std::uint64_t bytes = 0;
  for (const Entry& entry : entries_) bytes += entry.bytes;
  return bytes;
}

std::shared_ptr<const measure::MeasuredResult> MeasuringCache::found(const std::string& scan_id,
                                                                     const std::string& version) {
  const std::lock_guard lock(mutex_);
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& one) {
    return one.scan_id == scan_id && one.version == version;
  });
  if (entry == entries_.end()) return nullptr;
  std::rotate(entry, entry + 1, entries_.end());
  return entries_.back().result;
}

void MeasuringCache::keep(Entry entry) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const Entry& one) { return one.scan_id == entry.scan_id; });
  std::uint64_t bytes = entry.bytes;
  for (const Entry& one : entries_) bytes += one.bytes;
  while (!entries_.empty() && (entries_.size() >= kMostScans || bytes > most_bytes_)) {
    bytes -= entries_.front().bytes;
    entries_.erase(entries_.begin());
  }
  entries_.push_back(std::move(entry));
}

}  // namespace hermite::server
