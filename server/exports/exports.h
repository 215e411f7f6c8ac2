// The exports of all scans: what there is, what is being made, what waits and what has failed, and why. A format of a scan that is ready is
// a blob of that scan and stays over restarts; what waits or runs is forgotten with the server, and asked for again.
//
// One is made at a time, by a thread that steps back behind all others. The mesh of a scan that has finished comes behind what people
// have asked for; of these tokens take turns. A disk without room, or one that takes nothing, is waited for. Belongs to the network thread.
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

// That wait or are made. All formats of a scan are about a dozen.
inline constexpr Share kExportShare{64, 16, 8};
inline constexpr std::size_t kMaxFailedExports = 1000;  // of which is known why; of more the oldest are forgotten

enum class ExportPhase { kMissing, kQueued, kRunning, kReady, kFailed };
const char* name_of(ExportPhase phase);  // "missing", "queued", ...

struct ExportState {
  const ExportOffer* format = nullptr;
  MeshShape shape;  // what is done to the mesh before
  ExportPhase phase = ExportPhase::kMissing;
  std::uint64_t size_bytes = 0;  // of one that is ready
  double done = 0;               // share, of one that is made
  std::string words;             // why it has failed, or still waits
};

struct ExportRequest {
  std::string scan_id;
  std::string format;  // ExportSpec::name
  std::string token_id;
  bool is_admin = false;  // held to the limit for all alone
};

class Exports {
 public:
  using Clock = std::chrono::steady_clock;
  struct Hooks {
    // Run a function soon: on the network thread, and on the one that makes exports. What was posted there ends before this does, or never
    // begins. Callable from every thread.
    std::function<void(std::function<void()>)> network, making;
    std::function<Result<ScanRow>(const std::string& scan_id)> find;  // kNotFound
    OpenFrames open_frames;
    std::function<Status(std::uint64_t bytes)> check_disk;                 // kBusy, in words: there is no room for so much
    std::function<void()> stored;                                          // there is one more
    std::function<void(const std::string& scan_id)> remove_files_of_scan;  // of one that is gone, whatever has come since
  };

  // `blobs` outlives this.
  Exports(Blobs& blobs, Hooks hooks);
  ~Exports();
  Exports(const Exports&) = delete;
  Exports& operator=(const Exports&) = delete;

  // Of every format that the scan has or has something to make it of, in the order of the table, and behind them those with options that
  // there are. kNotFound: no such scan. kBusy: it is
  // running. kIo.
  Result<std::vector<ExportState>> list(const std::string& scan_id);

  // As above; kNotFound also: there is no such format; kInvalidArgument: its options.
  Result<ExportState> state(const std::string& scan_id, const std::string& format);

  // Makes it, unless it is there, waits or is being made; one that has failed is tried again. Errors as of state(), and kNotFound: the scan
  // has nothing to make it of; kInvalidArgument: its cloud has no points; kBusy: too many wait, the server stops, or
  // the scan has kMaxShapedExports with options already.
  Status request(const ExportRequest& request);

  // Of a scan that has just finished: its mesh for the viewer, if it has points and there is room to wait.
  void make_mesh(const ScanRow& scan);

  // Takes it from those that wait, stops it, or removes what there is. Errors as of state(); kInvalidArgument also: it is no export, but a
  // result of the scan; kNotFound also: there is nothing of it.
  Status remove(const std::string& scan_id, const std::string& format);

  void tick(Clock::time_point now);  // now and then: stops what is for a scan that is gone, and begins what waits
  void stop();                       // begins nothing any more, and stops what is made
  std::size_t running_count() const { return running_ ? 1 : 0; }
  std::size_t waiting_count() const { return waiting_.size(); }

 private:
  using Key = std::pair<std::string, std::string>;  // scan, name of the export
  // What the thread that makes an export and this one both look at.
  struct Progress {
    std::atomic<bool> stopped = false;
    std::atomic<double> done = 0;
  };
  struct Work {
    ExportSpec spec;
    std::string token_id;          // whose turn it is
    bool asked_for = false;        // by somebody
    std::int64_t ended_at_ms = 0;  // of the scan: another one when its results are others
    std::uint64_t number = 0;      // the older, the smaller
    std::string words;
    Clock::time_point begin_at;
    std::chrono::seconds pause{0};
  };
  struct Running {
    Key key;
    Work work;
    std::shared_ptr<Progress> progress = std::make_shared<Progress>();
    bool unwanted = false;  // also when it is stored already
  };
  struct Failed {
    std::string words;
    std::uint64_t number = 0;
  };
  Result<ScanRow> find_ended(const std::string& scan_id) const;
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
  void built(Result<std::string> bytes);
  void put(const std::shared_ptr<const std::string>& bytes);
  void stored(const Status& put, std::uint64_t size_bytes);
  void wait_for_room(const Error& why);
  void fail(const Error& why);
  void end_running();

  Blobs& blobs_;
  const Hooks hooks_;
  ExportBuilder builder_;  // of the thread that makes exports
  std::map<Key, Work> waiting_;
  std::optional<Running> running_;
  std::map<Key, Failed> failed_;
  std::map<std::string, std::uint64_t> last_turn_;  // by token
  std::uint64_t count_ = 0;
  Clock::time_point now_;  // of the last tick
  Clock::time_point idle_since_, swept_at_;
  bool builder_keeps_ = false;  // a mesh that may be wanted again
  bool stopping_ = false;
};

}  // namespace hermite
