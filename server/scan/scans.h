// All scans of this server: who runs, and what was left by an earlier server or has ended. Belongs
// to the network thread; only the workers of scans have threads of their own.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/access/gate.h"
#include "server/access/places.h"
#include "server/disk/log_readers.h"
#include "server/disk/storage.h"
#include "server/operations/frame_traces.h"
#include "server/operations/metrics.h"
#include "server/scan/ended_scans.h"
#include "server/scan/left_scans.h"
#include "server/scan/live_scan.h"
#include "server/scan/scan_launcher.h"
#include "server/scan/scan_room.h"
#include "server/scan/scan_rows.h"
#include "server/scan/shown_scans.h"

namespace hermite::server {

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

class Scans {
 public:
  // Continues the scans that an earlier server left running (left_scans.h). The members of
  // `storage`, and `metrics`, outlive this. Throws SetupError when the store fails.
  Scans(ScansOptions options, const Storage& storage, Metrics& metrics,
        const LogReaders::Threads& threads);

  Places& places() { return places_; }    // where cameras wait for their scan to start
  LogReaders& logs() { return logs_; }    // where cameras wait for the log of their scan
  ShownScans& shown() { return shown_; }  // where viewers wait for the results of an ended scan
  ScanRows& rows() { return rows_; }      // of all scans
  ScanRoom& room() { return room_; }      // on the disk and in the owners' storage
  EndedScans& ended_scans() { return ended_; }
  Blobs& blobs() const { return storage_.blobs; }
  const FrameTraces& traces() const { return launcher_.traces(); }

  // kBusy: a quota is used up, or the server is stopping. kInvalidArgument: a setting. kIo: the
  // store or the disk. A camera can reconnect to a resumable scan.
  Result<StartedScan> start(const wire::StartScan& request, const Grant& grant, bool resumable);

  // An error tells the camera why it cannot continue. kBusy: not now, but later. None: the scan has
  // ended; see EndedScans::when_told().
  Result<std::optional<ResumedScan>> resume(const wire::ResumeScan& request);

  // Starts the scan of a job, with the id that the job has chosen, or continues the one that an
  // earlier server left. It takes no place of its token, and stays running when the server stops.
  // Its upload, if any, does not count against the storage, since it is removed when the scan is
  // finished. Call it only if has_room_for(). None: the frame log of the earlier scan is still
  // being read; call again. Errors as of start().
  Result<std::optional<JobScan>> run_for_job(const std::string& scan_id,
                                             const std::string& upload_id, const ScanOwner& owner,
                                             const wire::StartScan& request);
  bool has_room_for(const std::string& scan_id) const;  // for a job: waiting cameras go first

  // Adds an imported scan, or one that another machine has made; its files exist already.
  // kInvalidArgument, kIo. `may_be_meshed`: its mesh is made automatically.
  Status add_imported(const ScanRow& row, bool may_be_meshed);

  // Removes what exists of the scan of a failed or cancelled job.
  void remove_unwanted(const std::string& scan_id);

  // The subscribers of a running or ended scan. Otherwise as ShownScans::watch().
  Result<std::shared_ptr<Subscribers>> watch(const std::string& scan_id);
  // A scan that runs and takes frames, until the next call of anything else here; nullptr: none.
  LiveScan* running(const std::string& scan_id) const;
  std::size_t running_count() const { return running_.size() + logs_.reading_count(); }

  // kBusy: it is running. kNotFound. kIo: it is not listed any more, but will be when the server
  // ends before its row is removed.
  Status remove(const std::string& scan_id);

  // Sets title and tags. kNotFound, kIo. Present viewers of an ended scan see the title when they
  // reconnect.
  Status label(const std::string& scan_id, const ScanLabels& labels);

  // Ends a running scan as interrupted, with results. kBusy: it has ended, has all its frames, or
  // belongs to a job. kNotFound, kIo.
  Status end(const std::string& scan_id);

  // Called periodically: ends scans whose camera timed out, and removes expired data by the given
  // time (retention_clock.h).
  void tick(LiveScan::Clock::time_point now, std::int64_t retention_now_ms);
  void refuse_new();  // accepts no new scans: the server is about to stop
  bool is_stopping() const { return stopping_; }
  // Running scans end as interrupted with results, or are continued by the next server.
  void stop();

  // Called with every scan that has finished successfully and is kept, once its end is stored.
  void when_finished(std::function<void(const ScanRow&)> then) { finished_ = std::move(then); }

  void describe(Load& load) const;                       // adds the load of the scans
  bool device_failed() const { return device_failed_; }  // in the last ended scan

 private:
  void ended(const ScanRow& started, const ScanEnd& end);
  std::vector<double> remaining_s() const;  // of running scans, for Places::tell()

  const ScansOptions options_;
  const Storage storage_;
  Metrics& metrics_;
  const LogReaders::Threads threads_;
  std::function<void(const ScanRow&)> finished_;
  ScanLauncher launcher_;  // before the scans, whose workers use it until they end
  RunningScans running_;
  ScanRows rows_;
  Places places_;
  LogReaders logs_;
  ScanRoom room_;
  ShownScans shown_;
  EndedScans ended_;
  LeftScans left_;
  FrameCounts ended_counts_;  // of all ended scans
  LiveScan::Clock::time_point told_to_wait_at_;
  bool device_failed_ = false;
  bool stopping_ = false;
};

}  // namespace hermite::server
