// All scans of this server: those that run and those that have ended. Belongs to the network thread; only the scans' workers run beside it.
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
#include "server/disk/storage.h"
#include "server/operations/frame_traces.h"
#include "server/operations/metrics.h"
#include "server/scan/live_scan.h"
#include "server/scan/scan_record.h"
#include "server/scan/stored_scan.h"

namespace hermite {

// Encoded frames that one scan may hold in its queue. With 2048 x 2048 pixels this leaves a window of 3 frames.
inline constexpr std::size_t kMaxQueuedBytes = 128 * 1024 * 1024;

struct ScansOptions {
  std::string device;  // as for Pipeline
  PlaceRules places;
  std::uint32_t credit_window = 16;                   // frames, at most
  int gpu_memory_mb = 0;                              // of all scans together, in equal shares; 0: as much as there is
  std::chrono::milliseconds resume_window{120'000};   // so long a scan waits for its lost camera
  std::chrono::milliseconds frame_patience{120'000};  // so long a camera may send nothing although there is room for a frame
  std::uint64_t min_free_disk_bytes = 0;              // that scans leave, beside room for their results
  int keep_log_days = 7;                              // after the end of a scan; 0: for ever
  std::chrono::milliseconds checkpoint_period{0};     // of scans that run; 0: none are written
};

// What a camera is told of the scan it has started.
struct StartedScan {
  std::shared_ptr<LiveScan> scan;
  wire::Welcome welcome;
};

// A scan that a job feeds, as a camera of this process would.
struct JobScan {
  std::shared_ptr<LiveScan> scan;
  std::uint64_t next_sequence = 0;   // the first frame that it does not have yet
  std::uint64_t frames_granted = 0;  // in all
  std::size_t max_message_bytes = 0;
};

// What a camera that comes back finds: its scan, still running.
struct ResumedScan {
  std::shared_ptr<LiveScan> scan;
  wire::Resumed resumed;
  std::size_t max_message_bytes = 0;  // as in its Welcome
};

// What is asked of Places for such a scan.
PlaceRequest place_request_of(const Grant& grant, wire::Mode mode);

// Whose scan it is, for its row and its share of the storage.
struct ScanOwner {
  std::string token_id;
  bool is_admin = false;
};

class Scans {
 public:
  // Runs a function on the network thread, soon. Callable from every thread.
  using Post = LogReaders::Post;

  // Goes on with the scans that an earlier server left running, from their frame logs; those without a usable one are interrupted. The
  // logs are read in the background, that of the oldest scan first. What is in `storage`, and `metrics`, outlive this. Throws SetupError
  // when the store cannot.
  Scans(ScansOptions options, const Storage& storage, Metrics& metrics, const LogReaders::Threads& threads);

  // Cameras wait there for a scan of theirs to begin.
  Places& places() { return places_; }

  // kBusy: a quota is used up, in words, or the server is stopping. kInvalidArgument: a setting. kIo: the store or the disk.
  // The camera can come back to a resumable one.
  Result<StartedScan> start(const wire::StartScan& request, const Grant& grant, bool resumable);

  // The scan of a job, with the id that the job has chosen for it: goes on with the one that an earlier server left, else begins. It takes
  // no place of its token's, and stays running when the server stops. The upload that it is made of, if any, does not count for the
  // storage: it goes when the scan is finished. Only while has_room_for(). None: the frame log of the one that was left is being read; ask
  // again. Errors as of start().
  Result<std::optional<JobScan>> run_for_job(const std::string& scan_id, const std::string& upload_id, const ScanOwner& owner,
                                             const wire::StartScan& request);
  ScanOwner owner_of(const std::string& token_id) const;  // as the store knows the token; one that it does not know may not administer
  bool has_room_for(const std::string& scan_id) const;    // of a job: cameras that wait go first

  // A scan that a job has brought along finished: its files are there. kInvalidArgument, kIo. `may_be_meshed`: its mesh is made by itself.
  Status add_imported(const ScanRow& row, bool may_be_meshed);
  // kBusy, in words: the disk or the owner's storage has no room for it, its upload left out. kIo.
  Status check_room_for_import(const std::string& upload_id, const ScanOwner& owner, std::uint64_t bytes) const;

  // What there is of the scan of a job that came to nothing.
  void remove_unwanted(const std::string& scan_id);

  // Any error means that the camera cannot go on; its words say why. kBusy: not now, but later. None: the scan has ended; see when_told().
  Result<std::optional<ResumedScan>> resume(const wire::ResumeScan& request);
  LogReaders& logs() { return logs_; }  // cameras wait there for the log of their scan to be read

  // kNotFound: no such scan. A scan that has ended is read from its files; one without files (failed) has nothing but its state. None: they
  // are being read in the background; ask again when_shown().
  Result<std::shared_ptr<Audience>> watch(const std::string& scan_id);
  using Ticket = std::uint64_t;
  Ticket when_shown(const std::string& scan_id, std::function<void()> then);  // once, later

  // All that there is to say to the camera of a scan that has ended, or in words why nothing: read in the background, told once, later.
  using LastWords = Result<std::vector<wire::ServerMessage>>;
  Ticket when_told(const wire::ResumeScan& request, std::function<void(LastWords)> then);
  void forget(Ticket ticket);  // of both

  // With the present counts for running scans; as Store has it, the newest for an empty id.
  Result<std::vector<ScanRow>> list(const std::string& older_than_id = "");
  Result<ScanRow> find(const std::string& scan_id);

  // kBusy: it is running. kNotFound.
  Status remove(const std::string& scan_id);

  // Another title, which `title` may be. kNotFound, kIo.
  Status rename(const std::string& scan_id, const std::string& title);

  // A scan that runs ends as interrupted, with what it has. kBusy: it has ended, has all its frames, or a job feeds it. kNotFound, kIo.
  Status end(const std::string& scan_id);

  // Bytes of a result of a scan that has ended. kNotFound: no such scan, or it has no such result.
  Result<std::uint64_t> size_of_result(const std::string& scan_id, const std::string& name);
  Blobs& blobs() const { return blobs_; }

  // Now and then: ends scans that have waited too long for their camera, and removes what is old by that time (retention_clock.h).
  void tick(LiveScan::Clock::time_point now, std::int64_t retention_now_ms);
  void refuse_new();  // the server is about to stop
  bool is_stopping() const { return stopping_; }
  void stop();  // no new scans; those that run end as interrupted, with results, or go on when there is a server again
  std::size_t running_count() const { return running_.size() + logs_.reading_count(); }

  // kBusy, in words: the disk has no room for another scan beside the results of those that run. kIo: that is not known. While they run
  // this is looked at again every second, and so is the storage of their owners: cameras are told when little is left, and a scan ends
  // while its results still fit.
  Status check_disk() const;
  Status check_disk_for(std::uint64_t bytes) const;  // the same for so many bytes of an export

  // kBusy, in words: the storage that the owner of a scan has a share of is used up. kNotFound, kIo.
  Status check_storage_of(const std::string& scan_id);

  // Called with every scan that has finished well and is kept, when it is known to have ended.
  void when_finished(std::function<void(const ScanRow&)> then) { finished_ = std::move(then); }

  void describe(Load& load) const;  // what is known here
  const FrameTraces& traces() const { return traces_; }
  bool device_failed() const { return device_failed_; }  // in the scan that ended last

 private:
  // A scan on its way from a row to being one of those that run. Its worker and log find it through `self`.
  struct Launch {
    ScanRow row;
    ScanRecord record;
    Options options;
    PlaceRequest place;
    std::shared_ptr<std::weak_ptr<LiveScan>> self = std::make_shared<std::weak_ptr<LiveScan>>();
  };
  // For so much more of the owner, and so much of others that is not there yet.
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
  std::vector<double> remaining_s() const;  // of the scans that run, as Places::tell() wants it
  // scans_left.cpp
  struct LeftScan {
    Launch launch;
    LogReaders::Opened opened;
  };
  PlaceRequest place_of_left(const ScanRow& row) const;
  void read_log(const ScanRow& row, const PlaceRequest& place, std::function<void(LeftScan)> then);
  Status run_left(LeftScan left);
  void interrupt_left(ScanRow row, const Error& why);
  void drop_left(const std::string& scan_id);
  // scans_disk.cpp
  std::uint64_t kept_back_bytes() const;
  struct Room {
    std::optional<Error> gone;  // none is left but for results
    std::string warning;        // little is
  };
  Room room_on_disk() const;
  Room room_in_storage(const std::string& scan_id) const;
  void watch_room();
  void rebuild_next(LiveScan::Clock::time_point now);
  void rebuild_ended(const ScanRow& row);
  // scans_ended.cpp
  LastWords last_words(const ScanRow& row, const wire::ResumeScan& request) const;
  void show(const std::string& scan_id, StoredScan stored);
  void store_end(const ScanRow& row);
  void store_ends_again();
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
  std::map<std::string, LeftScan> left_for_jobs_;              // by id; their logs were read
  std::map<std::string, std::weak_ptr<Audience>> read_again_;  // ended scans that someone is looking at
  // And those whose results are being read, with who waits for them.
  std::map<std::string, std::map<Ticket, std::function<void()>>> being_read_;
  std::map<Ticket, std::function<void(LastWords)>> to_be_told_;  // cameras of such scans
  Ticket next_ticket_ = 0;
  std::map<std::string, ScanRow> unstored_ends_;  // by id: scans that have ended, of which the store does not know it yet
  FrameCounts ended_counts_;                      // of all scans that have ended
  FrameTraces traces_;
  LiveScan::Clock::time_point old_logs_removed_at_, told_to_wait_at_, room_watched_at_;
  std::string rebuilding_;  // id of the scan whose results are made again; empty: none
  LiveScan::Clock::time_point rebuild_at_;
  std::chrono::seconds rebuild_pause_{0};
  bool device_failed_ = false;
  bool stopping_ = false;
};

}  // namespace hermite
