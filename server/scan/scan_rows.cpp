#include "server/scan/scan_rows.h"

#include <fmt/core.h>

#include <utility>

#include "server/store/scan_id.h"

namespace hermite::server {

ScanRows::ScanRows(Store& store, const RunningScans& running)
    : store_(store),
      running_(running),
      ends_("scan", "that it has ended",
            [&store](const ScanRow& row) { return store.scans.update(row); }),
      removals_("scan", "that it is removed",
                [&store](const ScanRow& row) { return store.scans.remove(row.id); }) {}

Result<std::vector<ScanRow>> ScanRows::list(const std::string& older_than_id) {
  Result<std::vector<ScanRow>> rows =
      older_than_id.empty() ? store_.scans.list() : store_.scans.list_older_than(older_than_id);
  if (!rows.ok()) return rows;
  std::erase_if(*rows, [this](const ScanRow& row) { return removals_.find(row.id); });
  for (ScanRow& row : *rows) row = as_it_is(std::move(row));
  return rows;
}

Result<ScanRow> ScanRows::find(const std::string& scan_id) {
  if (!is_scan_id(scan_id))
    return Error{ErrorCode::kNotFound,
                 "there is no such scan: an id has 26 characters of a-z and 0-9"};
  Result<ScanRow> row = store_.scans.find(scan_id);
  if (!row.ok()) return row;
  if (removals_.find(scan_id))
    return Error{ErrorCode::kNotFound, fmt::format("scan {} is removed", scan_id)};
  return as_it_is(*std::move(row));
}

Status ScanRows::label(const std::string& scan_id, const ScanLabels& labels) {
  if (Status labelled = store_.scans.label(scan_id, labels); !labelled.ok()) return labelled;
  if (ScanRow* const ended = ends_.find(scan_id)) {
    ended->title = labels.title.value_or(ended->title);
    ended->tags = labels.tags.value_or(ended->tags);
  }
  return Done{};
}

ScanRow ScanRows::as_it_is(ScanRow row) const {
  const auto running = running_.find(row.id);
  if (running == running_.end()) {
    const ScanRow* const unstored = ends_.find(row.id);
    return unstored ? *unstored : row;
  }
  const FrameCounts& counts = running->second->frames().counts();
  row.frames_received = static_cast<std::int64_t>(counts.received);
  row.frames_processed = static_cast<std::int64_t>(counts.processed);
  row.frames_dropped = static_cast<std::int64_t>(counts.dropped);
  return row;
}

ScanOwner ScanRows::owner_of(const std::string& token_id) const {
  const Result<TokenRow> row = store_.tokens.find(token_id);
  return {token_id, row.ok() && row->scopes.admin};
}

Status ScanRows::end(const ScanRow& ended) { return ends_.make(ended); }

Status ScanRows::remove(const ScanRow& row) {
  ends_.forget(row.id);
  return removals_.make(row);
}

void ScanRows::begin_again(const std::string& scan_id) {
  ends_.forget(scan_id);
  removals_.forget(scan_id);
}

void ScanRows::tick(std::chrono::steady_clock::time_point now) {
  ends_.tick(now);
  removals_.tick(now);
}

}  // namespace hermite::server
