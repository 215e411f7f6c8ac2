#include "server/service/scans.h"

#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/dataset/trajectory.h"
#include "proto/wire/frame_payload.h"
#include "proto/wire/server_message.h"
#include "server/store/chunk_file.h"
#include "server/store/scan_id.h"

namespace hermite {

namespace {

constexpr std::size_t kLiveQueueFrames = 4;  // older ones are not worth waiting for

std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

ScanPhase stored_phase(wire::ScanPhase phase) {
  switch (phase) {
    case wire::ScanPhase::kRunning: return ScanPhase::kRunning;
    case wire::ScanPhase::kFinished: return ScanPhase::kFinished;
    case wire::ScanPhase::kFailed: return ScanPhase::kFailed;
    case wire::ScanPhase::kInterrupted: return ScanPhase::kInterrupted;
  }
  return ScanPhase::kFailed;
}

wire::ScanPhase wire_phase(ScanPhase phase) {
  switch (phase) {
    case ScanPhase::kRunning: return wire::ScanPhase::kRunning;
    case ScanPhase::kFinished: return wire::ScanPhase::kFinished;
    case ScanPhase::kFailed: return wire::ScanPhase::kFailed;
    case ScanPhase::kInterrupted: return wire::ScanPhase::kInterrupted;
  }
  return wire::ScanPhase::kFailed;
}

Result<std::string> read_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return Error{ErrorCode::kNotFound, "there is no " + path};
  std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (stream.bad()) return Error{ErrorCode::kIo, "reading " + path};
  return bytes;
}

ModelUpdate model_of(StoredChunks stored) {
  ModelUpdate model;
  std::uint64_t version = 0;
  for (EncodedChunk& chunk : stored.chunks) {
    wire::Chunk message{
        {chunk.key.submap, chunk.key.level, chunk.key.x, chunk.key.y, chunk.key.z}, ++version, chunk.point_count, std::move(chunk.draco)};
    const bool empty = chunk.point_count == 0;
    model.chunks.push_back({chunk.key, empty, std::make_shared<const std::string>(wire::format_server_message(std::move(message)))});
  }
  for (const StoredSubmap& submap : stored.submaps) model.poses.poses.push_back({submap.submap, submap.world_from_submap});
  return model;
}

// What the report says about the map; 0 where there is none.
void read_map_counts(const std::string& folder, wire::ScanState& state) {
  const Result<std::string> text = read_file(folder + "/report.json");
  if (!text.ok()) return;
  const nlohmann::json report = nlohmann::json::parse(*text, nullptr, false);
  const nlohmann::json mapping = report.is_object() ? report.value("mapping", nlohmann::json()) : nlohmann::json();
  const auto count = [&mapping](const char* name) -> std::uint64_t {
    const auto found = mapping.is_object() ? mapping.find(name) : mapping.end();
    return found != mapping.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
  };
  state.keyframes = count("keyframes");
  state.loops = count("loops by appearance") + count("loops by nearness");
}

// What is there is shown: a scan that failed has no files, and that is no error of the viewer.
void show_files(const std::string& folder, Audience& audience) {
  const Result<std::string> text = read_file(folder + "/trajectory.txt");
  if (text.ok()) {
    const Result<Trajectory> trajectory = parse_tum_trajectory(*text);
    if (!trajectory.ok()) spdlog::error("{}/trajectory.txt: {}", folder, trajectory.error().message);
    std::vector<float> positions_m;
    for (const TimedPose& pose : trajectory.ok() ? *trajectory : Trajectory{})
      for (const double axis : pose.world_from_camera.translation) positions_m.push_back(static_cast<float>(axis));
    audience.set_positions(std::move(positions_m));
  }
  const Result<std::string> bytes = read_file(folder + "/chunks.bin");
  if (!bytes.ok()) return;
  Result<StoredChunks> stored = parse_chunk_file(*bytes);
  if (!stored.ok()) {
    spdlog::error("{}/chunks.bin: {}", folder, stored.error().message);
    return;
  }
  audience.show_model(model_of(*std::move(stored)));
}

}  // namespace

Scans::Scans(ScansOptions options, const DataDirectory& data, Store& store, Post post)
    : options_(std::move(options)), data_(data), store_(store), post_(std::move(post)) {
  const Result<int> interrupted = store_.interrupt_running("the server ended during the scan", now_ms());
  if (!interrupted.ok()) throw SetupError(interrupted.error());
  if (*interrupted > 0) spdlog::warn("{} scan(s) of an earlier run were left unfinished and are now interrupted", *interrupted);
}

ScanEvents Scans::events_for(const std::shared_ptr<LiveScan>& scan) const {
  // Weak: an event that is still under way must not keep a scan alive, nor its worker.
  const auto deliver = [post = post_, weak = std::weak_ptr(scan)](auto tell) {
    post([weak, tell = std::move(tell)]() mutable {
      if (const std::shared_ptr<LiveScan> target = weak.lock()) tell(*target);
    });
  };
  ScanEvents events;
  events.frame_done = [deliver](FrameOutcome outcome) {
    deliver([outcome = std::move(outcome)](LiveScan& target) { target.frame_done(outcome); });
  };
  events.model_changed = [deliver](ModelUpdate update) {
    deliver([update = std::move(update)](LiveScan& target) mutable { target.model_changed(std::move(update)); });
  };
  events.ended = [deliver](ScanEnd end) { deliver([end = std::move(end)](LiveScan& target) mutable { target.ended(std::move(end)); }); };
  return events;
}

Status Scans::check_quotas(const Grant& grant) const {
  const auto busy = [](const std::string& words) { return Error{ErrorCode::kBusy, words}; };
  if (running_.size() >= static_cast<std::size_t>(options_.max_running))
    return busy("this server runs at most " + std::to_string(options_.max_running) + " scans at once; try again when one has ended");
  const auto own = std::count_if(owners_.begin(), owners_.end(), [&grant](const auto& entry) { return entry.second == grant.token_id; });
  if (!may(grant, Scope::kAdmin) && own >= options_.max_running_per_token)
    return busy("this token may run at most " + std::to_string(options_.max_running_per_token) +
                " scans at once; try again when one has ended");
  if (options_.storage_bytes == 0) return Done{};
  const Result<std::uint64_t> stored_bytes = data_.stored_bytes();
  if (!stored_bytes.ok()) return stored_bytes.error();
  if (*stored_bytes >= options_.storage_bytes)
    return busy("the scans on this server take " + std::to_string(*stored_bytes / 1'000'000) + " MB of the " +
                std::to_string(options_.storage_bytes / 1'000'000) + " MB that they may take: delete some");
  return Done{};
}

Result<StartedScan> Scans::start(const wire::StartScan& request, const Grant& grant) {
  if (stopping_) return Error{ErrorCode::kBusy, "the server is stopping"};
  if (Status status = check_quotas(grant); !status.ok()) return status.error();
  Options options;
  for (const auto& [key, value] : request.settings)
    if (Status status = apply_setting(options, key, value); !status.ok()) return in_context("start_scan.settings", status.error());

  if (const int share_mb = options_.gpu_memory_mb / options_.max_running; share_mb > 0) {
    int& wanted_mb = options.map.gpu_memory_mb;
    wanted_mb = wanted_mb == 0 ? share_mb : std::min(wanted_mb, share_mb);
  }

  ScanRow row;
  row.id = new_scan_id();
  row.title = request.title;
  row.camera = request.camera;
  row.created_at_ms = now_ms();
  if (Status status = data_.create_scan_folder(row.id); !status.ok()) return status.error();
  if (Status status = store_.add(row); !status.ok()) {
    if (Status removed = data_.remove_scan_folder(row.id); !removed.ok()) spdlog::error("{}", removed.error().message);
    return status.error();
  }

  const std::size_t max_message_bytes = wire::max_frame_message_bytes(request.camera);
  const auto window = static_cast<std::uint32_t>(std::clamp<std::size_t>(kMaxQueuedBytes / max_message_bytes, 1, options_.credit_window));
  const bool live = request.mode == wire::Mode::kLive;
  auto audience = std::make_shared<Audience>(SceneInfo{row.id, row.title, row.camera});
  auto scan = std::make_shared<LiveScan>(ScanTerms{request.mode, window}, audience, [this, row](const ScanEnd& end) { ended(row, end); });
  running_[row.id] = scan;
  owners_[row.id] = grant.token_id;
  const std::size_t queue_capacity = live ? std::min<std::size_t>(window, kLiveQueueFrames) : window;
  scan->start(
      std::make_unique<ScanWorker>(ScanSetup{options_.device, request.camera, options, request.depth_codecs.front(), queue_capacity,
                                             data_.scan_folder(row.id), live ? CorrectionTime::kWhenReady : CorrectionTime::kByFrames},
                                   events_for(scan)));
  spdlog::info("scan {} started: {}x{}, {}", row.id, row.camera.width, row.camera.height, live ? "live" : "batch");

  wire::Welcome welcome;
  welcome.scan_id = row.id;
  welcome.max_message_bytes = max_message_bytes;
  welcome.frame_credit = window;
  welcome.depth_codec = request.depth_codecs.front();
  welcome.camera = row.camera;
  welcome.title = row.title;
  return StartedScan{std::move(scan), std::move(welcome)};
}

void Scans::ended(const ScanRow& started, const ScanEnd& end) {
  ScanRow row = with_counts(started);
  row.phase = stored_phase(end.phase);
  row.words = end.words;
  row.finished_at_ms = now_ms();
  if (Status status = store_.update(row); !status.ok()) spdlog::error("scan {}: {}", row.id, status.error().message);
  spdlog::info("scan {} {}: {} frames received, {} processed, {} dropped{}{}", row.id, name_of(row.phase), row.frames_received,
               row.frames_processed, row.frames_dropped, row.words.empty() ? "" : "; ", row.words);
  const auto running = running_.find(row.id);
  read_again_[row.id] = running->second->shared_audience();
  // Not at once: this is called by the scan itself.
  post_([scan = running->second] {});
  running_.erase(running);
  owners_.erase(row.id);
}

ScanRow Scans::with_counts(ScanRow row) const {
  const auto running = running_.find(row.id);
  if (running == running_.end()) return row;
  const FrameCounts& counts = running->second->counts();
  row.frames_received = static_cast<std::int64_t>(counts.received);
  row.frames_processed = static_cast<std::int64_t>(counts.processed);
  row.frames_dropped = static_cast<std::int64_t>(counts.dropped);
  return row;
}

Result<std::shared_ptr<Audience>> Scans::watch(const std::string& scan_id) {
  if (const auto running = running_.find(scan_id); running != running_.end()) return running->second->shared_audience();
  std::erase_if(read_again_, [](const auto& entry) { return entry.second.expired(); });
  if (const auto known = read_again_.find(scan_id); known != read_again_.end()) return known->second.lock();
  const Result<ScanRow> row = find(scan_id);
  if (!row.ok()) return row.error();
  auto audience = std::make_shared<Audience>(SceneInfo{row->id, row->title, row->camera});
  show_files(data_.scan_folder(scan_id), *audience);
  wire::ScanState state{wire_phase(row->phase), row->words, static_cast<std::uint64_t>(row->frames_received),
                        static_cast<std::uint64_t>(row->frames_processed), static_cast<std::uint64_t>(row->frames_dropped)};
  read_map_counts(data_.scan_folder(scan_id), state);
  audience->show_state(state);
  audience->close();
  read_again_[scan_id] = audience;
  return audience;
}

Result<std::vector<ScanRow>> Scans::list() {
  Result<std::vector<ScanRow>> rows = store_.list();
  if (!rows.ok()) return rows;
  for (ScanRow& row : *rows) row = with_counts(std::move(row));
  return rows;
}

Result<ScanRow> Scans::find(const std::string& scan_id) {
  if (!is_scan_id(scan_id)) return Error{ErrorCode::kNotFound, "there is no such scan: an id has 26 characters of a-z and 0-9"};
  Result<ScanRow> row = store_.find(scan_id);
  if (!row.ok()) return row;
  return with_counts(*std::move(row));
}

Status Scans::remove(const std::string& scan_id) {
  if (running_.contains(scan_id)) return Error{ErrorCode::kBusy, "scan " + scan_id + " is running"};
  if (Result<ScanRow> row = find(scan_id); !row.ok()) return row.error();
  if (Status status = data_.remove_scan_folder(scan_id); !status.ok()) return status;
  read_again_.erase(scan_id);
  return store_.remove(scan_id);
}

Result<std::string> Scans::file_of(const std::string& scan_id, const std::string& name) {
  if (Result<ScanRow> row = find(scan_id); !row.ok()) return row.error();
  const std::string path = data_.scan_folder(scan_id) + "/" + name;
  struct stat status {};
  if (running_.contains(scan_id) || lstat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
    return Error{ErrorCode::kNotFound, "scan " + scan_id + " has no " + name + (running_.contains(scan_id) ? " yet" : "")};
  return path;
}

void Scans::stop() {
  stopping_ = true;
  for (const auto& [id, scan] : running_) scan->stop();
}

}  // namespace hermite
