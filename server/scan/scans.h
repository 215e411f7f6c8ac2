// All scans of this server, running and ended. Belongs to the network thread; only the workers of scans have threads of their own.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/access/gate.h"
#include "server/access/places.h"
#include "server/disk/log_readers.h"
#include "server/disk/pending_changes.h"
#include "server/disk/storage.h"
#include "server/operations/frame_traces.h"
#include "server/operations/metrics.h"
#include "server/scan/live_scan.h"
#include "server/scan/scan_record.h"
#include "server/scan/shown_scans.h"

namespace hermite {

// The most encoded bytes that one scan may queue. With 2048 x 2048 pixels this allows a window of 3 frames.
inline constexpr std::size_t kMaxQueuedBytes = 128 * 1024 * 1024;

struct ScansOptions {
  std::string device;  // as for Pipeline
  PlaceRules places;
  std::uint32_t credit_window = 16;                   // frames, at most
  int gpu_memory_mb = 0;                              // of all scans together, in equal shares; 0: all there is
  std::chrono::milliseconds resume_window{120'000};   // how long a scan waits for its lost camera
  std::chrono::milliseconds frame_patience{120'000};  // how long a camera with credit may send nothing
  std::uint64_t min_free_disk_bytes = 0;              // that scans must leave, besides room for their results
  int keep_log_days = 7;                              // after the end of the scan; 0: for ever
  std::chrono::milliseconds checkpoint_period{0};     // of running scans; 0: none
};

// The answer to a camera that has started a scan.
struct StartedScan {
  std::shared_ptr<LiveScan> scan;
  wire::Welcome welcome;
};

// A scan whose frames come from a job of this process.
struct JobScan {
  std::shared_ptr<LiveScan> scan;
  std::uint64_t next_sequence = 0;   // the first frame that it lacks
  std::uint64_t frames_granted = 0;  // total
  std::size_t max_message_bytes = 0;
};

// The answer to a camera that reconnects to its running scan.
struct ResumedScan {
  std::shared_ptr<LiveScan> scan;
  wire::Resumed resumed;
  std::size_t max_message_bytes = 0;  // as in its Welcome
};

// The request to Places for such a scan.
PlaceRequest place_request_of(const Grant& grant, wire::Mode mode);

// The owner of a scan, for its row and the storage quota.
struct ScanOwner {
  std::string token_id;
  bool is_admin = false;
};

class Scans {
 public:
  // Runs a function on the network thread soon. Callable from every thread.
  using Post = LogReaders::Post;

  // Continues the scans that an earlier server left running, from their frame logs; scans without a usable log become interrupted. The logs
  // are read in the background, that of the oldest scan first. The members of `storage`, and `metrics`, outlive this. Throws SetupError
  // when the store fails.
  Scans(ScansOptions options, const Storage& storage, Metrics& metrics, const LogReaders::Threads& threads);

  // Where cameras wait for their scan to start.
  Places& places() { return places_; }

  // kBusy: a quota is used up, or the server is stopping. kInvalidArgument: a setting. kIo: the store or the disk.
  // A camera can reconnect to a resumable scan.
  Result<StartedScan> start(const wire::StartScan& request, const Grant& grant, bool resumable);

  // Starts the scan of a job, with the id that the job has chosen, or continues the one that an earlier server left. It takes no place of
  // its token, and stays running when the server stops. Its upload, if any, does not count against the storage, since it is removed when
  // the scan is finished. Call it only if has_room_for(). None: the frame log of the earlier scan is still being read; call again. Errors
  // as of start().
  Result<std::optional<JobScan>> run_for_job(const std::string& scan_id, const std::string& upload_id, const ScanOwner& owner,
                                             const wire::StartScan& request);
  ScanOwner owner_of(const std::string& token_id) const;  // from the store; an unknown token is no administrator
  bool has_room_for(const std::string& scan_id) const;    // for a job: waiting cameras go first

  // Adds an imported scan whose files exist already. kInvalidArgument, kIo. `may_be_meshed`: its mesh is made automatically.
  Status add_imported(const ScanRow& row, bool may_be_meshed);
  // kBusy: the disk or the owner's storage has no room for it, not counting its upload. kIo.
  Status check_room_for_import(const std::string& upload_id, const ScanOwner& owner, std::uint64_t bytes) const;

  // Removes what exists of the scan of a failed or cancelled job.
  void remove_unwanted(const std::string& scan_id);

  // An error tells the camera why it cannot continue. kBusy: not now, but later. None: the scan has ended; see when_told().
  Result<std::optional<ResumedScan>> resume(const wire::ResumeScan& request);
  LogReaders& logs() { return logs_; }  // where cameras wait for the log of their scan

  // The subscribers of a running or ended scan. Otherwise as ShownScans::watch().
  Result<std::shared_ptr<Subscribers>> watch(const std::string& scan_id);
  ShownScans& shown() { return shown_; }  // where viewers wait for the results of an ended scan

  // The final message to the camera of an ended scan, or why there is none: read in the background and reported once, later.
  using LastMessages = Result<std::vector<wire::ServerMessage>>;
  using Ticket = std::uint64_t;
  Ticket when_told(const wire::ResumeScan& request, std::function<void(LastMessages)> then);
  void forget(Ticket ticket);  // cancels when_told()

  // With present counts for running scans; otherwise as Store: the newest scan for an empty id.
  Result<std::vector<ScanRow>> list(const std::string& older_than_id = "");
  Result<ScanRow> find(const std::string& scan_id);

  // kBusy: it is running. kNotFound. kIo: it is not listed any more, but will be when the server ends before its row is removed.
  Status remove(const std::string& scan_id);

  // Sets the title. kNotFound, kIo.
  Status rename(const std::string& scan_id, const std::string& title);

  // Ends a running scan as interrupted, with results. kBusy: it has ended, has all its frames, or belongs to a job. kNotFound, kIo.
  Status end(const std::string& scan_id);

  // The bytes of a result of an ended scan. kNotFound: no such scan or result.
  Result<std::uint64_t> size_of_result(const std::string& scan_id, const std::string& name);
  Blobs& blobs() const { return blobs_; }
  // A scan that runs and takes frames, until the next call of anything else here; nullptr: none.
  const LiveScan* running(const std::string& scan_id) const;
  // Where the frames of a scan with that id (is_scan_id) are, or were.
  std::string log_folder(const std::string& scan_id) const { return data_.log_folder(scan_id); }

  // Called periodically: ends scans whose camera timed out, and removes expired data by the given time (retention_clock.h).
  void tick(LiveScan::Clock::time_point now, std::int64_t retention_now_ms);
  void refuse_new();  // accepts no new scans: the server is about to stop
  bool is_stopping() const { return stopping_; }
  void stop();  // running scans end as interrupted with results, or are continued by the next server
  std::size_t running_count() const { return running_.size() + logs_.reading_count(); }

  // kBusy: the disk has no room for another scan besides the results of the running ones. kIo: its free space is unknown. While scans run
  // this and the storage of their owners are checked every second: cameras are warned when little is left, and a scan is ended while its
  // results still fit.
  Status check_disk() const;
  Status check_disk_for(std::uint64_t bytes) const;  // the same for this many bytes of an export

  // kBusy: the storage quota of the scan's owner is used up. kNotFound, kIo.
  Status check_storage_of(const std::string& scan_id);

  // Called with every scan that has finished successfully and is kept, once its end is stored.
  void when_finished(std::function<void(const ScanRow&)> then) { finished_ = std::move(then); }

  void describe(Load& load) const;  // adds the load of the scans
  const FrameTraces& traces() const { return traces_; }
  bool device_failed() const { return device_failed_; }  // in the last ended scan

 private:
  // A scan that is being started. Its worker and log refer to it through `self`.
  struct Launch {
    ScanRow row;
    ScanRecord record;
    Options options;
    PlaceRequest place;
    std::shared_ptr<std::weak_ptr<LiveScan>> self = std::make_shared<std::weak_ptr<LiveScan>>();
  };
  // Checks room for this many bytes of the owner, besides reserved bytes of others.
  struct ToCome {
    std::uint64_t bytes = 1, bytes_of_others = 0;
  };
  Status check_storage(const ScanOwner& owner, const std::string& except_upload_id, const ToCome& to_come) const;
  std::chrono::milliseconds frame_patience_of(const wire::StartScan& request) const;
  Result<Launch> launch_of(const std::string& scan_id, const wire::StartScan& request, const std::string& resume_token,
                           const ScanOwner& owner, const PlaceRequest& place) const;
  Result<std::shared_ptr<LiveScan>> begin(const Launch& launch);
  template <class Tell>
  void deliver(const Launch& launch, Tell tell) const;
  ScanEvents worker_events(const Launch& launch, const ScanPast& past);
  FrameLogEvents log_events(const Launch& launch) const;
  std::shared_ptr<LiveScan> run(const Launch& launch, FrameLog::Opened opened);
  void ended(const ScanRow& row, const ScanEnd& end);
  ScanRow as_it_is(ScanRow row) const;
  std::vector<double> remaining_s() const;  // of running scans, for Places::tell()
  // scans_left.cpp
  struct LeftScan {
    Launch launch;
    LogReaders::Opened opened;
  };
  PlaceRequest place_of_left(const ScanRow& row) const;
  void read_log(const ScanRow& row, const PlaceRequest& place, std::function<void(LeftScan)> then);
  bool remove_refused(const ScanRow& row);
  Status run_left(LeftScan left);
  void interrupt_left(ScanRow row, const Error& why);
  void drop_left(const std::string& scan_id);
  // scans_disk.cpp
  std::uint64_t kept_back_bytes() const;
  struct Room {
    std::optional<Error> gone;  // no room except for results
    std::string warning;        // little room is left
  };
  Room room_on_disk() const;
  Room room_in_storage(const std::string& scan_id) const;
  void watch_room();
  void rebuild_next(LiveScan::Clock::time_point now);
  void rebuild_ended(const ScanRow& row);
  // scans_ended.cpp
  LastMessages last_messages(const ScanRow& row, const wire::ResumeScan& request) const;
  void remove_old_logs(std::int64_t now_ms);
  void remove_old_logs_of(const std::vector<std::string>& scan_ids, std::int64_t now_ms);

  const ScansOptions options_;
  const Storage storage_;
  const DataDirectory& data_;
  Store& store_;
  Metrics& metrics_;
  Blobs& blobs_;
  const Post post_, background_;
  std::function<void(const ScanRow&)> finished_;
  std::map<std::string, std::shared_ptr<LiveScan>> running_;  // by id
  Places places_;
  LogReaders logs_;
  std::map<std::string, LeftScan> left_for_jobs_;  // by id, after their logs were read
  ShownScans shown_;
  std::map<Ticket, std::function<void(LastMessages)>> to_be_told_;  // cameras of ended scans
  Ticket next_ticket_ = 0;
  PendingChanges<ScanRow> unstored_ends_;      // otherwise an ended scan would be listed as running
  PendingChanges<ScanRow> unstored_removals_;  // not listed any more: their files are gone
  FrameCounts ended_counts_;                   // of all ended scans
  FrameTraces traces_;
  LiveScan::Clock::time_point old_logs_removed_at_, told_to_wait_at_, room_watched_at_;
  std::string rebuilding_;  // the scan whose results are being made again; empty: none
  LiveScan::Clock::time_point rebuild_at_;
  std::chrono::seconds rebuild_pause_{0};
  bool device_failed_ = false;
  bool stopping_ = false;
};

}  // namespace hermite
