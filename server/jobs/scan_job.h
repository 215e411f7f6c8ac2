// A reconstruction job: unpacks an upload, or opens the frame log of a scan, and streams the frames
// into a new scan as a camera would. So the result equals that of streaming, viewers see the scan
// grow, and after a crash it continues where its log ends.
//
// A separate thread reads and encodes; everything else belongs to the network thread.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/archive/unpack.h"
#include "server/jobs/job_frames.h"
#include "server/jobs/local_executor.h"
#include "server/scan/scans.h"
#include "server/store/data_directory.h"

namespace hermite::server {

// Shared by all jobs, and outlives them.
struct ScanJobWorld {
  Scans& scans;
  const DataDirectory& data;
  // Runs a function on the network thread soon; callable from any thread.
  std::function<void(std::function<void()>)> post;
  archive::UnpackLimits limits;
  std::uint64_t min_free_disk_bytes = 0;
};

class ScanJob : public JobWork {
 public:
  // Starts working. `row` has the id of the new scan.
  ScanJob(const ScanJobWorld& world, JobRow row, JobEvents events);
  ~ScanJob() override;  // waits for the current frame
  ScanJob(const ScanJob&) = delete;
  ScanJob& operator=(const ScanJob&) = delete;

  void cancel() override;
  void stop() override;
  void tick() override;

 private:
  // Instructions for the thread, guarded by mutex_.
  struct Feed {
    bool begun = false;
    bool stopped = false;
    std::uint64_t next_sequence = 0;
    std::uint64_t granted = 0;  // total credit in frames
    std::size_t max_message_bytes = 0;
  };

  // On the thread.
  void run();
  Result<std::unique_ptr<JobFrames>> open_source();
  Result<archive::UnpackLimits> unpack_limits(const std::string& upload) const;
  Result<std::string> recording_path();
  Result<dataset::Recording> open_upload(const std::string& path,
                                         const wire::StartScan& request) const;
  Status feed(JobFrames& source);
  void tell_remarks(JobFrames& source);
  bool is_stopped();
  void report(JobStage stage);
  void on_network(std::function<void()> action);

  // On the network thread.
  void source_is_open(const wire::StartScan& request);
  void begin_scan();
  void thread_ended(const Status& fed);
  void stop_thread();
  void said(const wire::ServerMessage& message);
  CameraLink link();
  void conclude();
  bool lacked_room() const;
  JobEnd verdict();

  const ScanJobWorld& world_;
  const JobRow row_;
  const JobEvents events_;
  // Logged frames of the scan that is reprocessed.
  std::uint64_t logged_frame_count_ = 0;
  // Functions posted for a destroyed job do nothing.
  const std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);

  std::optional<wire::StartScan> waiting_;  // the source is open, but its scan has no place yet
  std::shared_ptr<LiveScan> scan_;
  std::optional<wire::ScanState> last_state_;
  std::optional<Error> failure_;
  bool cancelled_ = false;
  bool stopping_ = false;
  bool went_away_ = false;
  std::atomic<bool> upload_lacks_room_ = false;  // the disk has no room now for the unpacked files
  bool scan_over_ = false;
  bool thread_over_ = false;
  bool ended_ = false;
  JobStage stage_;

  std::mutex mutex_;
  std::condition_variable changed_;
  Feed feed_;
  std::thread thread_;  // last member: the thread uses the others
};

}  // namespace hermite::server
