#include "server/jobs/scan_job.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <utility>
#include <variant>

#include "core/dataset/camera_file.h"
#include "proto/wire/client_message.h"
#include "server/jobs/job_request.h"
#include "server/store/disk_space.h"

namespace hermite::server {

namespace {

constexpr std::chrono::milliseconds kReportPeriod(100);  // of the unpacking progress
constexpr const char* kTracking = "tracking";

// Error messages must not reveal paths of the server.
std::string without_path(std::string message, const std::string& path, const std::string& instead) {
  for (std::size_t at = 0; (at = message.find(path, at)) != std::string::npos; at += instead.size())
    message.replace(at, path.size(), instead);
  return message;
}

}  // namespace

ScanJob::ScanJob(const ScanJobWorld& world, JobRow row, JobEvents events)
    : world_(world), row_(std::move(row)), events_(std::move(events)) {
  if (row_.source == JobSource::kScan)
    if (const Result<ScanRow> scan = world_.scans.rows().find(row_.source_id); scan.ok())
      logged_frame_count_ = static_cast<std::uint64_t>(scan->frames_received);
  thread_ = std::thread([this] { run(); });
}

ScanJob::~ScanJob() {
  stop_thread();
  thread_.join();
}

void ScanJob::on_network(std::function<void()> action) {
  world_.post([alive = std::weak_ptr<bool>(alive_), action = std::move(action)] {
    if (alive.lock()) action();
  });
}

bool ScanJob::is_stopped() {
  const std::lock_guard lock(mutex_);
  return feed_.stopped;
}

void ScanJob::report(JobStage stage) {
  on_network([this, stage = std::move(stage)] { events_.progress(stage); });
}

void ScanJob::run() {
  Status fed = Done{};
  try {
    Result<std::unique_ptr<JobFrames>> source = open_source();
    fed = source.ok() ? feed(**source) : Status(source.error());
  } catch (const std::exception& error) {
    // Most likely out of memory: only this job fails.
    fed = Error{ErrorCode::kIo, std::string("the job failed: ") + error.what()};
  }
  if (const Status removed = world_.data.remove_job_folder(row_.id); !removed.ok())
    spdlog::warn("{}", removed.error().message);
  on_network([this, fed] { thread_ended(fed); });
}

Result<std::unique_ptr<JobFrames>> ScanJob::open_source() {
  wire::StartScan request;
  request.title = row_.title;
  request.settings = settings_of(row_);
  if (row_.source == JobSource::kScan)
    return logged_frames(world_.data.log_folder(row_.source_id), logged_frame_count_, request);
  const Result<std::string> path = recording_path();
  if (!path.ok()) return path.error();
  report({"opening"});
  Result<dataset::Recording> recording = open_upload(*path, request);
  if (!recording.ok())
    return Error{recording.error().code,
                 without_path(recording.error().message, *path,
                              row_.title.empty() ? "the upload" : row_.title)};
  if (recording->sequence->frame_count() == 0)
    return Error{ErrorCode::kCorruptData, "the recording has no frames"};
  if (request.title.empty()) request.title = "upload";
  return recorded_frames(*std::move(recording), std::move(request));
}

// What the disk has room for, now and if it were empty, beside the upload and the space that must
// stay free.
Result<archive::UnpackLimits> ScanJob::unpack_limits(const std::string& upload) const {
  const Result<std::uint64_t> free = free_bytes(world_.data.path());
  if (!free.ok()) return free.error();
  const Result<std::uint64_t> capacity = disk_capacity_bytes(world_.data.path());
  if (!capacity.ok()) return capacity.error();
  std::error_code error;
  const std::uintmax_t packed_bytes = std::filesystem::file_size(upload, error);
  if (error) return Error{ErrorCode::kIo, "asking for the size of the upload: " + error.message()};
  const auto without = [](std::uint64_t bytes, std::uint64_t taken) {
    return bytes - std::min(bytes, taken);
  };
  archive::UnpackLimits limits = world_.limits;
  const Result<Inodes> inodes = disk_inodes(world_.data.path());
  if (!inodes.ok()) return inodes.error();
  const std::uint64_t kept_inodes = world_.min_free_disk_bytes / kBytesPerInode;
  limits.room_inodes = without(inodes->free, kept_inodes);
  limits.capacity_inodes = without(inodes->all, kept_inodes);
  limits.room_bytes = without(*free, world_.min_free_disk_bytes);
  limits.capacity_bytes = without(without(*capacity, world_.min_free_disk_bytes), packed_bytes);
  // Inodes count as bytes there.
  limits.has_room_left = [&data = world_.data, kept_bytes = world_.min_free_disk_bytes] {
    const Result<std::uint64_t> bytes_now = free_bytes(data.path());
    return bytes_now.ok() && *bytes_now >= kept_bytes;
  };
  return limits;
}

// The uploaded file itself, or the folder that it was unpacked into.
Result<std::string> ScanJob::recording_path() {
  const std::string upload = world_.data.upload_path(row_.source_id);
  if (!archive::is_archive(upload)) return upload;
  report({"unpacking"});
  if (const Status status = world_.data.create_job_folder(row_.id); !status.ok())
    return status.error();
  const std::string folder = world_.data.job_folder(row_.id) + "/recording";
  const Result<archive::UnpackLimits> limits = unpack_limits(upload);
  if (!limits.ok()) return limits.error();
  auto told_at = std::chrono::steady_clock::now();
  const Result<archive::UnpackSummary> unpacked =
      archive::unpack_archive(upload, folder, *limits, [&](std::uint64_t output_bytes) {
        const auto now = std::chrono::steady_clock::now();
        if (now - told_at >= kReportPeriod) {
          told_at = now;
          report({"unpacking", static_cast<std::int64_t>(output_bytes), 0});
        }
        return !is_stopped();
      });
  upload_lacks_room_ = !unpacked.ok() && unpacked.error().code == ErrorCode::kBusy;
  if (!unpacked.ok())
    return Error{unpacked.error().code,
                 without_path(unpacked.error().message, upload,
                              row_.title.empty() ? "the upload" : row_.title)};
  on_network([this, message = fmt::format("{}: {} files unpacked, {} bytes", unpacked->kind,
                                          unpacked->file_count, unpacked->output_bytes)] {
    events_.log(message);
  });
  return folder;
}

Result<dataset::Recording> ScanJob::open_upload(const std::string& path,
                                                const wire::StartScan& request) const {
  const Result<std::optional<Camera>> camera = camera_of(row_);
  if (!camera.ok()) return camera.error();
  Result<dataset::Recording> recording = dataset::open_recording(path, *camera);
  if (recording.ok() || *camera) return recording;
  // The folder name of a benchmark recording tells its camera. Of an upload only the title is left
  // of that name.
  const std::optional<Camera> mentioned = dataset::camera_mentioned_in(request.title);
  if (!mentioned) return recording;
  Result<dataset::Recording> again = dataset::open_recording(path, mentioned);
  return again.ok() ? std::move(again) : std::move(recording);
}

void ScanJob::tell_remarks(JobFrames& source) {
  for (std::string& remark : source.take_remarks())
    on_network([this, message = std::move(remark)] { events_.log(message); });
}

Status ScanJob::feed(JobFrames& source) {
  tell_remarks(source);
  on_network([this, request = source.request()] { source_is_open(request); });
  Feed allowed;
  const auto wait = [this, &allowed](auto enough) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return feed_.stopped || enough(feed_); });
    allowed = feed_;
    return !feed_.stopped;
  };
  if (!wait([](const Feed& feed) { return feed.begun; })) return Done{};
  if (Status status = source.skip(allowed.next_sequence); !status.ok()) return status;
  for (;;) {
    Result<std::optional<wire::Frame>> frame = source.next();
    tell_remarks(source);
    if (!frame.ok()) return frame.error();
    if (!*frame) break;
    const std::uint64_t sequence = (*frame)->sequence;
    std::string message = wire::format_client_message(**frame);
    if (message.size() > allowed.max_message_bytes)
      return Error{ErrorCode::kTooLarge,
                   fmt::format("frame {} takes {} bytes, allowed are {}", sequence, message.size(),
                               allowed.max_message_bytes)};
    if (!wait([sequence](const Feed& feed) { return feed.granted > sequence; })) return Done{};
    auto shared = std::make_shared<std::pair<wire::Frame, std::string>>(**std::move(frame),
                                                                        std::move(message));
    on_network([this, shared] {
      if (scan_over_) return;
      if (const Status status = scan_->receive(std::move(shared->first), shared->second);
          !status.ok()) {
        failure_ = status.error();
        scan_->discard();
      }
    });
  }
  on_network([this] {
    if (!scan_over_) scan_->finish();
  });
  return Done{};
}

void ScanJob::source_is_open(const wire::StartScan& request) {
  waiting_ = request;
  begin_scan();
}

void ScanJob::begin_scan() {
  if (!waiting_ || cancelled_ || stopping_) return;
  if (!world_.scans.has_room_for(row_.scan_id)) {
    events_.progress({"waiting for a free place"});
    return;
  }
  const std::string upload_id = row_.source == JobSource::kUpload ? row_.source_id : "";
  const Result<std::optional<JobScan>> found = world_.scans.run_for_job(
      row_.scan_id, upload_id, world_.scans.rows().owner_of(row_.token_id), *waiting_);
  if (found.ok() && !*found) {
    events_.progress({"reading the frame log"});
    return;
  }
  const wire::StartScan request = *std::exchange(waiting_, std::nullopt);
  if (!found.ok()) {
    failure_ = found.error();
    stop_thread();
    return;
  }
  const std::optional<JobScan>& begun = *found;
  scan_ = begun->scan;
  stage_ = {kTracking, static_cast<std::int64_t>(scan_->frames().counts().processed),
            static_cast<std::int64_t>(request.expected_frames)};
  events_.progress(stage_);
  if (begun->next_sequence > 0)
    events_.log(fmt::format("goes on with frame {}", begun->next_sequence));
  scan_->attach_camera(link());
  {
    const std::lock_guard lock(mutex_);
    feed_.begun = true;
    feed_.next_sequence = begun->next_sequence;
    feed_.granted = begun->frames_granted;
    feed_.max_message_bytes = begun->max_message_bytes;
  }
  changed_.notify_all();
}

CameraLink ScanJob::link() {
  // Called from inside the scan, which must outlive the call, so everything that follows is posted.
  const std::weak_ptr<bool> alive = alive_;
  const auto later = [this, alive](bool away) {
    if (!alive.lock()) return;
    went_away_ = went_away_ || away;
    on_network([this] {
      scan_over_ = true;
      conclude();
    });
  };
  return {[this, alive](const wire::ServerMessage& message) {
            if (alive.lock()) said(message);
          },
          [later] { later(false); }, [] {}, [later] { later(true); }};
}

void ScanJob::said(const wire::ServerMessage& message) {
  if (const auto* credit = std::get_if<wire::Credit>(&message)) {
    {
      const std::lock_guard lock(mutex_);
      feed_.granted = std::max(feed_.granted, credit->frames_granted);
    }
    changed_.notify_all();
  } else if (const auto* result = std::get_if<wire::FrameResult>(&message)) {
    stage_.done = static_cast<std::int64_t>(result->sequence) + 1;
    stage_.name = stage_.total > 0 && stage_.done >= stage_.total ? "finishing" : kTracking;
    events_.progress(stage_);
  } else if (const auto* state = std::get_if<wire::ScanState>(&message)) {
    last_state_ = *state;
  } else if (const auto* error = std::get_if<wire::ErrorMessage>(&message);
             error && error->about_frame) {
    events_.log(fmt::format("frame {}: {}", error->sequence, error->message));
  }
}

void ScanJob::stop_thread() {
  {
    const std::lock_guard lock(mutex_);
    feed_.stopped = true;
  }
  changed_.notify_all();
}

void ScanJob::cancel() {
  if (cancelled_) return;
  cancelled_ = true;
  stop_thread();
  if (scan_ && !scan_over_) scan_->discard();
}

// Scans stops a running scan itself, at the right time.
void ScanJob::stop() {
  stopping_ = true;
  if (!scan_) stop_thread();
}

void ScanJob::tick() { begin_scan(); }

// The thread has ended: the source is exhausted, was stopped, or failed.
void ScanJob::thread_ended(const Status& fed) {
  thread_over_ = true;
  if (!fed.ok() && !failure_) failure_ = fed.error();
  if (!fed.ok() && scan_ && !scan_over_) scan_->discard();
  conclude();
}

// Ends the job once both the thread and the scan have ended.
void ScanJob::conclude() {
  stop_thread();
  if (ended_ || !thread_over_ || (scan_ && !scan_over_)) return;
  ended_ = true;
  events_.ended(verdict());
}

// Whether it failed for lack of disk space, so that it should be retried, rather than because of
// its content.
bool ScanJob::lacked_room() const {
  if (upload_lacks_room_ || (scan_ && scan_->lifecycle().lacked_room())) return true;
  const bool of_disk = failure_ ? failure_->code == ErrorCode::kIo : scan_ && last_state_;
  return of_disk && !world_.scans.room().check_disk().ok();
}

JobEnd ScanJob::verdict() {
  const bool postponed = went_away_ || (!scan_ && stopping_ && !failure_);
  if (postponed && !cancelled_) return {JobState::kQueued, {}};
  const bool finished = last_state_ && last_state_->phase == wire::ScanPhase::kFinished;
  if (!cancelled_ && !failure_ && finished) return {JobState::kFinished, last_state_->message};
  const bool again = lacked_room();  // asked now, before removing the scan frees space
  // A scan without result leaves nothing behind.
  world_.scans.remove_unwanted(row_.scan_id);
  if (cancelled_) return {JobState::kCancelled, {}};
  const std::string message = failure_      ? failure_->message
                              : last_state_ ? last_state_->message
                                            : "the scan ended without giving a reason";
  if (again) return {JobState::kQueued, message, true};
  return {JobState::kFailed, message};
}

}  // namespace hermite::server
