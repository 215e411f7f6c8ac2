#include "server/disk/storage_quota.h"

#include <fmt/core.h>

#include <memory>
#include <utility>

namespace hermite::server {

namespace {

// A running scan writes some 50 MB in that time, while limits are gigabytes.
constexpr std::chrono::seconds kPeriod(5);
// Measuring takes at most this fraction (1/20) of the time of a thread and a disk.
constexpr int kShareOfTime = 20;

std::string megabytes(std::uint64_t bytes) { return fmt::format("{} MB", bytes / 1'000'000); }

}  // namespace

StorageQuota::StorageQuota(std::uint64_t limit_bytes, std::function<Result<Sizes>()> measure,
                           LogReaders::Threads threads)
    : limit_bytes_(limit_bytes),
      measure_(std::move(measure)),
      threads_(std::move(threads)),
      sizes_(Sizes()) {
  if (!has_limit()) return;
  const Clock::time_point start = Clock::now();
  measured(measure_(), Clock::now() - start);
}

Share storage_share(std::uint64_t limit_bytes) {
  const auto limit = static_cast<std::int64_t>(limit_bytes);
  return {limit, limit / 2, limit / 20};
}

Status StorageQuota::check(std::uint64_t upload_bytes, std::uint64_t more_bytes,
                           const StorageAsker& asker) const {
  if (!has_limit()) return Done{};
  if (!sizes_.ok()) return sizes_.error();
  std::uint64_t held_bytes = upload_bytes, own_bytes = asker.upload_bytes;
  for (const auto& [id, bytes] : *sizes_) held_bytes += bytes;
  for (const std::string& id : asker.scan_ids)
    if (const auto own = sizes_->find(id); own != sizes_->end()) own_bytes += own->second;
  const Share share = storage_share(limit_bytes_);
  const auto busy = [](const std::string& whose, std::uint64_t held, std::int64_t allowed) {
    return Error{
        ErrorCode::kBusy,
        fmt::format("the scans and uploads {} take {} of the {} that they may take: delete some, "
                    "or wait until jobs have ended",
                    whose, megabytes(held), megabytes(static_cast<std::uint64_t>(allowed)))};
  };
  const auto fits = [more_bytes](std::uint64_t held, std::int64_t allowed) {
    return held + more_bytes <= static_cast<std::uint64_t>(allowed);
  };
  if (!asker.is_admin && !fits(own_bytes, share.per_token))
    return busy("of this token", own_bytes, share.per_token);
  const std::int64_t allowed = asker.is_admin ? share.in_all : share.in_all - share.for_admins;
  return fits(held_bytes, allowed) ? Status(Done{}) : busy("on this server", held_bytes, allowed);
}

void StorageQuota::removed(const std::string& scan_id) {
  if (measuring_) removed_meanwhile_.insert(scan_id);
  if (sizes_.ok()) sizes_->erase(scan_id);
}

void StorageQuota::files_changed() {
  outdated_ = true;
  measure(Clock::now());
}

void StorageQuota::tick(Clock::time_point now) {
  if (now >= measure_at_) measure(now);
}

void StorageQuota::measure(Clock::time_point start) {
  if (!has_limit() || measuring_) return;
  measuring_ = true;
  outdated_ = false;
  threads_.background([this, start] {
    auto sizes = std::make_shared<Result<Sizes>>(measure_());
    threads_.network(
        [this, sizes, took = Clock::now() - start] { measured(std::move(*sizes), took); });
  });
}

void StorageQuota::measured(Result<Sizes> sizes, Clock::duration took) {
  measuring_ = false;
  sizes_ = std::move(sizes);
  if (sizes_.ok())
    for (const std::string& id : removed_meanwhile_) sizes_->erase(id);
  removed_meanwhile_.clear();
  measure_at_ = Clock::now() + std::max<Clock::duration>(kPeriod, kShareOfTime * took);
  if (outdated_) measure(Clock::now());
}

}  // namespace hermite::server
