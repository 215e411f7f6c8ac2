// The exports of all scans: which are ready, queued, running or failed, and why. A finished export is a blob of its scan and survives
// restarts; queued and running ones are lost when the server ends and have to be requested again.
//
// One export is made at a time, by a thread of low priority. Exports that people requested come before meshes that are made automatically;
// among them tokens take turns. When the disk is full or cannot be written, the export waits and is retried. Belongs to the network thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "server/exports/build_export.h"
#include "server/exports/export_offer.h"
#include "server/exports/export_spec.h"
#include "server/store/blobs.h"
#include "server/store/scan_row.h"
#include "server/store/shares.h"

namespace hermite {

// Limits of queued and running exports. A scan has about a dozen formats.
inline constexpr Share kExportShare{64, 16, 8};
inline constexpr std::size_t kMaxFailedExports = 1000;  // whose errors are kept; the oldest are dropped

enum class ExportPhase { kMissing, kQueued, kRunning, kReady, kFailed };
const char* name_of(ExportPhase phase);  // "missing", "queued", ...

struct ExportState {
  const ExportOffer* format = nullptr;
  MeshShape shape;            // how the mesh is processed first
  std::string other_scan_id;  // only of a comparison
  ExportPhase phase = ExportPhase::kMissing;
  std::uint64_t size_bytes = 0;  // when ready
  double done = 0;               // fraction, while running
  std::string words;             // why it failed, or still waits
};

struct ExportRequest {
  std::string scan_id;
  std::string format;  // ExportSpec::name, of a format
  std::string token_id;
  bool is_admin = false;  // only the limit for all tokens together applies
};

class Exports {
 public:
  using Clock = std::chrono::steady_clock;
  struct Hooks {
    // Run a function soon, on the network thread and on the thread that makes exports. Functions posted to the latter end before this
    // object does, or never begin. Callable from every thread.
    std::function<void(std::function<void()>)> network, making;
    std::function<Result<ScanRow>(const std::string& scan_id)> find;  // kNotFound
    OpenFrames open_frames;
    std::function<Status(std::uint64_t bytes)> check_disk;                 // kBusy: there is no room for this many bytes
    std::function<void()> stored;                                          // an export was stored
    std::function<void(const std::string& scan_id)> remove_files_of_scan;  // removes files that were written after the scan was deleted
  };

  // `blobs` outlives this.
  Exports(Blobs& blobs, Hooks hooks);
  ~Exports();
  Exports(const Exports&) = delete;
  Exports& operator=(const Exports&) = delete;

  // Every format that the scan has or can be exported to, in the order of the table, followed by its exports with options.
  // kNotFound: no such scan. kBusy: it is
  // running. kIo.
  Result<std::vector<ExportState>> list(const std::string& scan_id);

  // One export. Errors as above, and kNotFound: no such format; kInvalidArgument: its options. `format` is never a comparison.
  Result<ExportState> state(const std::string& scan_id, const std::string& format);

  // The comparisons of the scan with others, as the first of both, by the id of the other scan. Those whose other scan was deleted are
  // removed and left out. Errors as of list().
  Result<std::vector<ExportState>> list_comparisons(const std::string& scan_id);

  // One comparison. Errors as of list(), for both scans; and kInvalidArgument: both are the same.
  Result<ExportState> comparison(const std::string& scan_id, const std::string& other_scan_id);

  // As request() and remove(). kBusy also: the scan already has kMaxComparisons.
  Status request_comparison(const ExportRequest& request, const std::string& other_scan_id);  // `request.format` is not read
  Status remove_comparison(const std::string& scan_id, const std::string& other_scan_id);

  // Removes the comparisons that others have with a scan which is about to be deleted, since they contain parts of it.
  void forget_comparisons_with(const std::string& scan_id);

  // Queues the export unless it is ready, queued or running; one that failed is tried again. Errors as of state(), and kNotFound: the scan
  // lacks the files that it is made from; kInvalidArgument: its cloud has no points; kBusy: too many are queued, the server stops, or
  // the scan already has kMaxShapedExports exports with options.
  Status request(const ExportRequest& request);

  // Queues the viewer's mesh of a scan that has just finished, if it has points and the queue is not full.
  void make_mesh(const ScanRow& scan);

  // Removes the export from the queue, stops it, or deletes its file. Errors as of state(), and kInvalidArgument: it is a result of the
  // scan rather than an export; kNotFound: there is no such export.
  Status remove(const std::string& scan_id, const std::string& format);

  void tick(Clock::time_point now);  // called periodically: stops exports of deleted scans and starts queued ones
  void stop();                       // starts no more exports, and stops the running one
  std::size_t running_count() const { return running_ ? 1 : 0; }
  std::size_t waiting_count() const { return waiting_.size(); }

 private:
  using Key = std::pair<std::string, std::string>;  // scan, name of the export
  // Shared by the network thread and the thread that makes the export.
  struct Progress {
    std::atomic<bool> stopped = false;
    std::atomic<double> done = 0;
  };
  struct Work {
    ExportSpec spec;
    std::string token_id;                // whose turn it is
    bool asked_for = false;              // by a person
    std::int64_t ended_at_ms = 0;        // of the scan; changes when its results are made again
    std::int64_t other_ended_at_ms = 0;  // the same of the second scan of a comparison
    std::uint64_t number = 0;            // increases with every request
    std::string words;
    Clock::time_point begin_at;
    std::chrono::seconds pause{0};
  };
  struct Running {
    Key key;
    Work work;
    std::shared_ptr<Progress> progress = std::make_shared<Progress>();
    bool unwanted = false;  // removed meanwhile; applies even after it was stored
  };
  struct Failed {
    std::string words;
    std::uint64_t number = 0;
  };
  Result<ScanRow> find_ended(const std::string& scan_id) const;
  Result<ScanRow> find_compared(const std::string& scan_id, const std::string& other_scan_id);
  Result<ExportState> stored_state(const std::string& scan_id, const ExportSpec& spec) const;
  Status request_spec(const ScanRow& scan, const ExportSpec& spec, const ExportRequest& asker);
  Status remove_spec(const std::string& scan_id, const ExportState& now);
  Status remove_files(const std::string& scan_id, const ExportSpec& spec);
  std::vector<std::string> compared_scans(const std::string& scan_id, const std::vector<BlobInfo>& blobs) const;
  Status check_comparisons(const std::string& scan_id, const ExportSpec& spec) const;
  bool is_unchanged(const std::string& scan_id, std::int64_t ended_at_ms) const;
  Status check_shaped(const std::string& scan_id, const ExportSpec& spec) const;
  std::vector<ExportSpec> shaped_exports(const std::string& scan_id, const std::vector<BlobInfo>& blobs) const;
  Status check_source(const std::string& scan_id, const ExportOffer& format) const;
  Result<std::uint64_t> source_bytes(const std::string& scan_id, const ExportOffer& format) const;
  Status add(const ScanRow& scan, const ExportSpec& spec, const ExportRequest& asker, bool asked_for);
  ExportState state_of(const std::string& scan_id, const ExportSpec& spec, std::optional<std::uint64_t> size_bytes) const;
  bool is_still_wanted(const Key& key, const Work& work) const;
  Taken taken_by(const std::string& token_id) const;
  void begin_next();
  std::map<Key, Work>::iterator next_of();
  void begin(const Key& key, Work work);
  void built(Result<NamedFiles> files);
  void put(const std::shared_ptr<const NamedFiles>& files);
  void stored(const Status& put, std::uint64_t size_bytes);
  bool remove_of_deleted();
  void wait_for_room(const Error& why);
  void fail(const Error& why);
  void end_running();

  Blobs& blobs_;
  const Hooks hooks_;
  ExportBuilder builder_;  // used by the thread that makes exports
  std::map<Key, Work> waiting_;
  std::optional<Running> running_;
  std::map<Key, Failed> failed_;
  std::map<std::string, std::uint64_t> last_turn_;  // by token
  std::uint64_t count_ = 0;
  Clock::time_point now_;  // of the last tick
  Clock::time_point idle_since_, swept_at_;
  bool builder_keeps_ = false;  // it keeps a mesh in memory
  bool stopping_ = false;
};

}  // namespace hermite
