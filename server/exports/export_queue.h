// Makes exports: those that are queued, the one that is being made, and why others failed. What is
// ready is not known here but to Exports, which owns this.
//
// One export is made at a time, by a thread of low priority. Exports that people requested come
// before meshes that are made automatically; among them tokens take turns. When the disk is full or
// cannot be written, the export waits and is retried. Belongs to the network thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/exports/build_export.h"
#include "server/exports/export_spec.h"
#include "server/store/blobs.h"
#include "server/store/scan_row.h"
#include "server/store/shares.h"

namespace hermite::server {

// Whose errors are kept; the oldest are dropped.
inline constexpr std::size_t kMaxFailedExports = 1000;

enum class ExportPhase { kMissing, kQueued, kRunning, kReady, kFailed };
const char* name_of(ExportPhase phase);  // "missing", "queued", ...

struct ExportHooks {
  // Run a function soon, on the network thread and on the thread that makes exports. Functions
  // posted to the latter end before the exports do, or never begin. Callable from every thread.
  std::function<void(std::function<void()>)> network, making;
  std::function<Result<ScanRow>(const std::string& scan_id)> find;  // kNotFound
  OpenFrames open_frames;
  // kBusy: there is no room for this many bytes.
  std::function<Status(std::uint64_t bytes)> check_disk;
  std::function<void()> stored;  // an export was stored
  // Removes files that were written after the scan was deleted.
  std::function<void(const std::string& scan_id)> remove_files_of_scan;
};

// Identifies an export of all scans.
struct ExportKey {
  std::string scan_id, name;  // ExportSpec::name()
  auto operator<=>(const ExportKey&) const = default;
};

struct ExportOrder {
  std::string scan_id;
  ExportSpec spec;
  std::string token_id;                // whose turn it is
  bool is_requested = false;           // by a person
  std::int64_t ended_at_ms = 0;        // of the scan; changes when its results are made again
  std::int64_t other_ended_at_ms = 0;  // the same of the second scan of a comparison
};

class ExportQueue {
 public:
  using Clock = std::chrono::steady_clock;

  // Both outlive this.
  ExportQueue(Blobs& blobs, const ExportHooks& hooks);
  ExportQueue(const ExportQueue&) = delete;
  ExportQueue& operator=(const ExportQueue&) = delete;

  struct Known {
    ExportPhase phase = ExportPhase::kMissing;  // or queued, running, failed
    double done = 0;                            // fraction, while running
    std::string message;                        // why it failed, or still waits
  };
  Known find(const ExportKey& key) const;

  // The exports of a scan that are queued, running or failed; those of names() by their
  // ExportSpec::name().
  std::vector<std::string> names(const std::string& scan_id) const;

  bool is_stopping() const { return stopping_; }
  // Returns whether the export waits, perhaps while an earlier order of it is still being made.
  bool is_waiting(const ExportKey& key) const { return waiting_.contains(key); }
  // Returns whether the export is being made but was dropped meanwhile.
  bool is_being_dropped(const ExportKey& key) const {
    return running_ && running_->key == key && running_->unwanted;
  }

  // Queues an export and forgets why it failed before.
  void add(ExportOrder order);
  void mark_requested(const ExportKey& key);  // by a person, if it is queued
  // Removes the export from the queue, stops it, and forgets why it failed.
  void drop(const ExportKey& key);
  void forget_failure(const ExportKey& key) { failed_.erase(key); }

  // Called periodically: stops exports of deleted scans and starts queued ones.
  void tick(Clock::time_point now);
  void stop();  // starts no more exports, and stops the running one
  std::size_t running_count() const { return running_ ? 1 : 0; }
  std::size_t waiting_count() const { return waiting_.size(); }
  Taken taken_by(const std::string& token_id) const;

 private:
  // Shared by the network thread and the thread that makes the export.
  struct Progress {
    std::atomic<bool> stopped = false;
    std::atomic<double> done = 0;
  };
  struct Work {
    ExportOrder order;
    std::uint64_t number = 0;  // increases with every order
    std::string message;
    Clock::time_point begin_at;
    std::chrono::seconds pause{0};
  };
  struct Running {
    ExportKey key;
    Work work;
    std::shared_ptr<Progress> progress = std::make_shared<Progress>();
    bool unwanted = false;  // dropped meanwhile; applies even after it was stored
  };
  struct Failed {
    std::string message;
    std::uint64_t number = 0;
  };
  bool is_still_wanted(const ExportOrder& order) const;
  bool is_unchanged(const std::string& scan_id, std::int64_t ended_at_ms) const;
  void begin_next();
  std::map<ExportKey, Work>::iterator next_of();
  void begin(const ExportKey& key, Work work);
  void built(Result<output::NamedFiles> files);
  void put(const std::shared_ptr<const output::NamedFiles>& files);
  void stored(const Status& put, std::uint64_t size_bytes);
  bool remove_of_deleted();
  void wait_for_room(const Error& why);
  void fail(const Error& why);
  void end_running();

  Blobs& blobs_;
  const ExportHooks& hooks_;
  ExportBuilder builder_;  // used by the thread that makes exports
  std::map<ExportKey, Work> waiting_;
  std::optional<Running> running_;
  std::map<ExportKey, Failed> failed_;
  std::map<std::string, std::uint64_t> last_turn_;  // by token
  std::uint64_t count_ = 0;
  Clock::time_point now_;  // of the last tick
  Clock::time_point idle_since_, swept_at_;
  bool builder_keeps_ = false;  // it keeps a mesh in memory
  bool stopping_ = false;
};

}  // namespace hermite::server
