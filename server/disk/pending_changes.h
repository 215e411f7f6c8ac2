// Changes of rows that the store could not take yet, as on a full disk: kept in memory, shown
// instead of what is stored, and tried again after a pause until the store has them or knows no
// such row. When the server ends before, the next one finds the rows as they were before the
// change, and recovers them like those of a server that died (left_scans.cpp, recover_jobs()).
// Belongs to one thread.
#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/base/result.h"

namespace hermite::server {

// Each attempt may take as long as a failing disk does.
inline constexpr std::chrono::seconds kChangeAgainAfter{5};
// While this many changes wait, callers begin nothing new that would need further changes.
inline constexpr std::size_t kMaxPendingChanges = 64;

// `Row` has a unique member `id`.
template <class Row>
class PendingChanges {
 public:
  using Clock = std::chrono::steady_clock;
  using Change = std::function<Status(const Row&)>;

  // For the log: the kind of a row, and what is to be stored, as in "scan", "that it has ended".
  PendingChanges(std::string kind, std::string what, Change change)
      : kind_(std::move(kind)), what_(std::move(what)), change_(std::move(change)) {}

  // Changes the row now, or keeps it to be changed later. Returns the store's answer; when that is
  // kNotFound, nothing is kept.
  Status make(const Row& row) {
    Status stored = change_(row);
    if (stored.ok() || stored.error().code == ErrorCode::kNotFound) {
      rows_.erase(row.id);
    } else {
      spdlog::error("{} {}: {} cannot be stored yet: {}", kind_, row.id, what_,
                    stored.error().message);
      rows_.insert_or_assign(row.id, row);
    }
    return stored;
  }

  // To be called regularly.
  void tick(Clock::time_point now) {
    if (rows_.empty()) return again_at_.reset();
    if (!again_at_) again_at_ = now + kChangeAgainAfter;
    if (now < *again_at_) return;
    again_at_ = now + kChangeAgainAfter;
    // Tries rows up to the first that fails, since then the others most likely fail, too. That row
    // is the last of the next attempt, so that it does not hold up the others for ever.
    for (std::size_t left = rows_.size(); left > 0; --left) {
      auto next = rows_.upper_bound(last_tried_);
      if (next == rows_.end()) next = rows_.begin();
      last_tried_ = next->first;
      const Status stored = change_(next->second);
      if (!stored.ok() && stored.error().code != ErrorCode::kNotFound) return;
      spdlog::info("{} {}: {} is stored now", kind_, next->first, what_);
      rows_.erase(next);
    }
  }

  // The row as it is to be stored, until the next call of anything here that is not const; nullptr:
  // it is as stored.
  Row* find(const std::string& id) {
    const auto found = rows_.find(id);
    return found == rows_.end() ? nullptr : &found->second;
  }
  const Row* find(const std::string& id) const {
    return const_cast<PendingChanges*>(this)->find(id);
  }

  void forget(const std::string& id) { rows_.erase(id); }  // another change has been stored since
  bool empty() const { return rows_.empty(); }
  bool full() const { return rows_.size() >= kMaxPendingChanges; }

 private:
  const std::string kind_, what_;
  const Change change_;
  std::map<std::string, Row> rows_;  // by id
  std::string last_tried_;
  std::optional<Clock::time_point> again_at_;
};

}  // namespace hermite::server
