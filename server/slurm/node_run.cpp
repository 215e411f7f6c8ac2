#include "server/slurm/node_run.h"

#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/sync_path.h"
#include "core/log/frame_log_reader.h"
#include "core/output/ply.h"
#include "server/disk/storage.h"
#include "server/jobs/scan_job.h"
#include "server/scan/checkpoint_file.h"
#include "server/scan/scan_record.h"
#include "server/scan/scans.h"
#include "server/slurm/attempts.h"
#include "server/slurm/task_queue.h"
#include "server/store/errno_error.h"
#include "server/store/file_blobs.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kNodeTick(100);
constexpr std::chrono::seconds kProgressPeriod(1);

// For the rows of the one scan; removed at the end.
class RowsFolder {
 public:
  RowsFolder() : path_((fs::temp_directory_path() / "hermite-work-XXXXXX").string()) {
    if (!mkdtemp(path_.data())) throw SetupError(errno_error("creating " + path_));
  }
  ~RowsFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  RowsFolder(const RowsFolder&) = delete;
  RowsFolder& operator=(const RowsFolder&) = delete;
  std::string database() const { return path_ + "/rows.db"; }

 private:
  std::string path_;
};

ScansOptions options_of_node(const NodeOrder& order) {
  ScansOptions options;
  options.device = order.device;
  options.places.max_running = 1;
  options.places.live_rate_hz = 0;
  options.gpu_memory_mb = order.gpu_memory_mb;
  options.min_free_disk_bytes = static_cast<std::uint64_t>(order.min_free_disk_mb) * 1'000'000;
  options.keep_log_days = 0;
  options.checkpoint_period = std::chrono::milliseconds(order.checkpoint_period_ms);
  return options;
}

std::uint64_t peak_memory_of_process() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Makes the row of a scan whose log and checkpoint were taken from an earlier run.
Result<ScanRow> row_of_log(const NodeOrder& order, const std::string& log_folder) {
  frame_log::FrameLogReader log(log_folder);
  const Result<std::optional<frame_log::LogRecord>> terms = log.next(), start = log.next();
  if (!terms.ok()) return terms.error();
  if (!start.ok()) return start.error();
  if (!*terms || !*start) return Error{ErrorCode::kCorruptData, "the copied frame log is empty"};
  const Result<ScanRecord> record = parse_scan_record((*terms)->payload, (*start)->payload);
  if (!record.ok()) return record.error();
  ScanRow row;
  row.id = order.job.scan_id;
  row.title = record->request.title;
  row.camera = record->request.camera;
  row.created_at_ms = unix_now_ms();
  return row;
}

// The parts of a server that a job needs. Members are declared in order of dependency.
class NodeServer {
 public:
  NodeServer(const NodeOrder& order, const std::string& attempt_folder, const std::string& folder)
      : order_(order),
        data_(folder),
        blobs_(data_.scans_folder()),
        waste_(data_.set_aside(), threads_.background),
        quota_(
            0, [] { return StorageQuota::Sizes(); }, threads_) {
    or_throw(place_source(attempt_folder));
    JobRow job = order_.job;
    job.state = JobState::kRunning;
    job.attempt_count = 1;
    or_throw(store_.jobs.add(job));
  }
  ~NodeServer() { background_.join(); }  // before what its functions use
  NodeServer(const NodeServer&) = delete;
  NodeServer& operator=(const NodeServer&) = delete;

  // Continues the scan of an earlier run; without success it begins anew.
  void go_on_from(const std::string& earlier) {
    const std::string from = earlier + "/scans/" + order_.job.scan_id,
                      to = data_.scan_folder(order_.job.scan_id);
    // The checkpoint first: the log of a run that still writes only grows meanwhile.
    Status taken = data_.create_scan_folder(order_.job.scan_id);
    if (taken.ok()) {
      std::error_code error;
      fs::copy_file(from + "/" + kCheckpointName, to + "/" + kCheckpointName, error);
      if (error) taken = Error{ErrorCode::kIo, "copying the checkpoint: " + error.message()};
    }
    if (taken.ok()) taken = copy_files(from + "/log", to + "/log");
    if (taken.ok()) {
      const Result<ScanRow> row = row_of_log(order_, to + "/log");
      taken = row.ok() ? store_.scans.add(*row) : Status(row.error());
    }
    if (taken.ok()) return lines_.push_back("goes on from a checkpoint");
    spdlog::warn("the checkpoint of {} cannot be used: {}", earlier, taken.error().message);
    (void)data_.remove_scan_folder(order_.job.scan_id);
  }

  NodeOutcome run(const std::string& folder, const std::atomic<bool>& stop) {
    const auto post = threads_.network;
    Scans scans(options_of_node(order_), {data_, store_, blobs_, waste_, quota_}, metrics_,
                threads_);
    const ScanJobWorld world{
        scans, data_, post, {}, static_cast<std::uint64_t>(order_.min_free_disk_mb) * 1'000'000};
    JobEvents events;
    events.progress = [this](JobStage stage) { stage_ = std::move(stage); };
    events.log = [this](const std::string& line) {
      spdlog::info("{}", line);
      if (lines_.size() < kMaxNodeLines) lines_.push_back(line);
    };
    events.ended = [this](const JobEnd& end) { end_ = end; };
    ScanJob job(world, order_.job, std::move(events));
    for (bool told = false; !end_ || scans.running_count() > 0;) {
      queue_.run_some(kNodeTick);
      scans.tick(std::chrono::steady_clock::now(), unix_now_ms());
      if (!end_) job.tick();
      if (stop && !std::exchange(told, true)) {
        spdlog::info("told to leave: a checkpoint is written");
        if (!end_) job.stop();
        scans.stop();
      }
      tell_progress(folder);
    }
    background_.join();
    // What holds an ended scan is released before what the scan refers to.
    for (int i = 0; i < 2; ++i) queue_.run_some(std::chrono::milliseconds(0));
    return outcome();
  }

 private:
  Status place_source(const std::string& attempt_folder) {
    const JobRow& job = order_.job;
    if (job.source == JobSource::kUpload)
      return link_or_copy(attempt_folder + "/recording", data_.upload_path(job.source_id));
    ScanRow source;
    source.id = job.source_id;
    source.phase = ScanPhase::kFinished;
    source.frames_received = static_cast<std::int64_t>(order_.logged_frame_count);
    if (Status made = data_.create_scan_folder(job.source_id); !made.ok()) return made;
    if (Status linked = link_files(attempt_folder + "/log", data_.log_folder(job.source_id));
        !linked.ok())
      return linked;
    return store_.scans.add(source);
  }

  void tell_progress(const std::string& folder) {
    const auto now = std::chrono::steady_clock::now();
    if (now - told_at_ < kProgressPeriod) return;
    told_at_ = now;
    const std::string text = format_stage(stage_);
    if (text == std::exchange(told_, text)) return;
    if (const Status written = output::write_file_atomically(folder + "/" + kProgressName, text);
        !written.ok())
      spdlog::warn("{}", written.error().message);
  }

  NodeOutcome outcome() {
    NodeOutcome outcome;
    outcome.words = end_->message;
    outcome.lines = lines_;
    outcome.peak_memory_bytes = peak_memory_of_process();
    if (end_->state == JobState::kQueued)
      outcome.end = end_->lacked_room ? NodeEnd::kNoRoom : NodeEnd::kStopped;
    if (end_->state != JobState::kFinished) return outcome;
    const Result<ScanRow> row = store_.scans.find(order_.job.scan_id);
    if (!row.ok()) throw SetupError(row.error());
    outcome.end = NodeEnd::kFinished;
    outcome.scan = *row;
    return outcome;
  }

  const NodeOrder order_;
  const DataDirectory data_;
  const RowsFolder rows_;
  Store store_{rows_.database()};
  FileBlobs blobs_;
  Metrics metrics_{"node"};
  TaskQueue queue_;
  asio::thread_pool background_{kMaxLogsRead + 1};
  const LogReaders::Threads threads_{
      [this](std::function<void()> action) { queue_.push(std::move(action)); },
      [this](std::function<void()> action) { asio::post(background_, std::move(action)); }};
  Waste waste_;
  StorageQuota quota_;
  std::optional<JobEnd> end_;
  JobStage stage_{"starting"};
  std::vector<std::string> lines_;
  std::string told_;
  std::chrono::steady_clock::time_point told_at_;
};

// The scan of a finished run as its result.
Status keep_result(const NodeOrder& order, const std::string& folder) {
  std::error_code error;
  fs::rename(folder + "/scans/" + order.job.scan_id, folder + "/" + kResultName, error);
  if (error) return Error{ErrorCode::kIo, "renaming the result: " + error.message()};
  return sync_path(folder);
}

}  // namespace

Result<NodeOutcome> run_on_node(const std::string& attempt_folder, int run,
                                const std::atomic<bool>& stop) {
  const Result<NodeOrder> order = read_order(attempt_folder);
  if (!order.ok()) return order.error();
  if (is_closed(attempt_folder))
    return Error{ErrorCode::kBusy, "the server has given this attempt up"};
  const std::string folder = run_folder(attempt_folder, run);
  if (mkdir(folder.c_str(), 0700) != 0) {
    if (errno == EEXIST) return Error{ErrorCode::kBusy, "run " + folder + " has begun already"};
    return errno_error("creating " + folder);
  }
  NodeOutcome outcome;
  {
    NodeServer server(*order, attempt_folder, folder);
    if (const auto earlier = run_to_go_on_from(attempt_folder, run, order->job.scan_id))
      server.go_on_from(*earlier);
    outcome = server.run(folder, stop);
  }
  if (outcome.end == NodeEnd::kFinished)
    if (const Status kept = keep_result(*order, folder); !kept.ok()) return kept.error();
  if (const Status written =
          output::write_file_atomically(folder + "/" + kOutcomeName, format_outcome(outcome));
      !written.ok())
    return written.error();
  return outcome;
}

}  // namespace hermite::server
