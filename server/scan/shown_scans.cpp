#include "server/scan/shown_scans.h"

#include <fmt/core.h>

#include <atomic>
#include <utility>

#include "core/base/check.h"
#include "server/store/chunk_file.h"

namespace hermite::server {

namespace {

wire::ScanPhase wire_phase(ScanPhase phase) {
  switch (phase) {
    case ScanPhase::kRunning: return wire::ScanPhase::kRunning;
    case ScanPhase::kFinished: return wire::ScanPhase::kFinished;
    case ScanPhase::kFailed: return wire::ScanPhase::kFailed;
    case ScanPhase::kInterrupted: return wire::ScanPhase::kInterrupted;
  }
  return wire::ScanPhase::kFailed;
}

wire::ScanState ended_state(const ScanRow& row, const wire::ScanState& map_counts) {
  wire::ScanState state = map_counts;
  state.phase = wire_phase(row.phase);
  state.message = row.message;
  state.frames_received = static_cast<std::uint64_t>(row.frames_received);
  state.frames_processed = static_cast<std::uint64_t>(row.frames_processed);
  state.frames_dropped = static_cast<std::uint64_t>(row.frames_dropped);
  return state;
}

}  // namespace

class ShownScans::Memory {
 public:
  explicit Memory(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  // Returns false if this is too much beside what is taken.
  bool take(std::uint64_t bytes) {
    std::uint64_t taken = taken_bytes_;
    do {
      if (taken > 0 && taken + bytes > most_bytes_) return false;
    } while (!taken_bytes_.compare_exchange_weak(taken, taken + bytes));
    return true;
  }
  void give_back(std::uint64_t bytes) { taken_bytes_ -= bytes; }

 private:
  const std::uint64_t most_bytes_;
  std::atomic<std::uint64_t> taken_bytes_ = 0;
};

// What was read of a scan. Its share of the memory is held until nobody has `share` any more.
struct ShownScans::Reading {
  StoredScan scan;
  std::shared_ptr<void> share;
};

ShownScans::ShownScans(Blobs& blobs, const LogReaders::Threads& threads,
                       std::function<Result<ScanRow>(const std::string&)> find,
                       std::uint64_t most_bytes)
    : blobs_(blobs),
      post_(threads.network),
      background_(threads.background),
      find_(std::move(find)),
      memory_(std::make_shared<Memory>(most_bytes)) {}

Result<std::shared_ptr<Subscribers>> ShownScans::watch(const std::string& scan_id) {
  if (const auto refused = refused_.find(scan_id); refused != refused_.end())
    return refused->second;
  std::erase_if(shown_, [](const auto& entry) { return entry.second.expired(); });
  if (const auto known = shown_.find(scan_id); known != shown_.end()) return known->second.lock();
  const Result<ScanRow> row = find_(scan_id);
  if (!row.ok()) return row.error();
  if (row->phase == ScanPhase::kRunning)
    return Error{
        ErrorCode::kBusy,
        "the scan has not been resumed yet after a restart of the server; try again later"};
  if (being_read_.contains(scan_id)) return std::shared_ptr<Subscribers>();
  being_read_[scan_id];
  background_([this, scan_id, &blobs = blobs_, memory = memory_] {
    const Result<std::uint64_t> size = blobs.size_bytes(scan_id, kChunksName);
    const std::uint64_t bytes = size.ok() ? *size : 0;
    // Posted functions are copied; the shared pointer avoids copying the points.
    auto reading = std::make_shared<Result<Reading>>(
        Error{ErrorCode::kBusy, fmt::format("the {} MB of points of this scan do not fit into "
                                            "memory beside those of other scans that are being "
                                            "looked at; try again later",
                                            bytes / 1'000'000)});
    if (memory->take(bytes)) {
      std::shared_ptr<void> share(nullptr, [memory, bytes](void*) { memory->give_back(bytes); });
      *reading = Reading{read_stored_scan(blobs, scan_id), std::move(share)};
    }
    post_([this, scan_id, reading] { show(scan_id, std::move(*reading)); });
  });
  return std::shared_ptr<Subscribers>();
}

ShownScans::Ticket ShownScans::when_shown(const std::string& scan_id, std::function<void()> then) {
  const auto reading = being_read_.find(scan_id);
  CHECK(reading != being_read_.end(), "watch() says when there is something to wait for");
  reading->second[next_ticket_] = std::move(then);
  return next_ticket_++;
}

void ShownScans::cancel(Ticket ticket) {
  for (auto& [scan_id, waiting] : being_read_) waiting.erase(ticket);
}

void ShownScans::show(const std::string& scan_id, Result<Reading> reading) {
  std::shared_ptr<Subscribers> subscribers;  // kept until the waiting viewers have it
  // If the scan was removed meanwhile, those who wait get the error when they ask again.
  const Result<ScanRow> row = find_(scan_id);
  if (!reading.ok()) {
    refused_.emplace(scan_id, reading.error());
  } else if (row.ok() && row->phase != ScanPhase::kRunning) {
    StoredScan& stored = reading->scan;
    subscribers = std::shared_ptr<Subscribers>(
        new Subscribers(SceneInfo{row->id, row->title, row->camera}),
        [share = reading->share](Subscribers* shown) { delete shown; });
    if (!stored.positions_m.empty()) subscribers->set_positions(std::move(stored.positions_m));
    if (stored.model) subscribers->show_model(*std::move(stored.model));
    subscribers->show_state(ended_state(*row, stored.map_counts));
    subscribers->close();
    shown_[scan_id] = subscribers;
  }
  // A callback may remove others from the map.
  for (auto& waiting = being_read_[scan_id]; !waiting.empty();)
    waiting.extract(waiting.begin()).mapped()();
  being_read_.erase(scan_id);
  refused_.erase(scan_id);
}

std::size_t ShownScans::viewer_count() const {
  std::size_t count = 0;
  for (const auto& [id, weak] : shown_)
    if (const std::shared_ptr<Subscribers> subscribers = weak.lock())
      count += subscribers->viewer_count();
  return count;
}

}  // namespace hermite::server
