#include "server/exports/exports.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/base/check.h"
#include "core/base/step_back.h"
#include "core/output/ply.h"

namespace hermite {

namespace {

constexpr std::chrono::seconds kFirstRoomPause(5), kLongestRoomPause(3600);  // as for scans whose results are made again (scans_disk.cpp)
constexpr std::chrono::minutes kKeepMesh(2);                                 // how long the last mesh stays in memory for another format
constexpr std::chrono::seconds kSweepPeriod(5);                              // how often queued exports of deleted scans are removed

// The blobs that a format can be made from; the first one that exists is used.
std::vector<std::string> sources_of(const ExportOffer& format) {
  if (format.is_result) return {std::string(format.file)};
  switch (format.kind) {
    case ExportKind::kMesh: return {std::string(kImportedMeshFile), kCloudFile};
    case ExportKind::kCloud: return {kCloudFile};
    case ExportKind::kPath: return {kTrajectoryFile};
    case ExportKind::kComparison: return {kSurfelsFile, kCloudFile};
  }
  return {};
}

}  // namespace

const char* name_of(ExportPhase phase) {
  switch (phase) {
    case ExportPhase::kMissing: return "missing";
    case ExportPhase::kQueued: return "queued";
    case ExportPhase::kRunning: return "running";
    case ExportPhase::kReady: return "ready";
    case ExportPhase::kFailed: return "failed";
  }
  return "missing";
}

Exports::Exports(Blobs& blobs, Hooks hooks) : blobs_(blobs), hooks_(std::move(hooks)), builder_(blobs, hooks_.open_frames) {
  hooks_.making([] { step_back(); });  // threads that it starts inherit the priority
}

Exports::~Exports() = default;

Result<ScanRow> Exports::find_ended(const std::string& scan_id) const {
  Result<ScanRow> row = hooks_.find(scan_id);
  if (row.ok() && row->phase == ScanPhase::kRunning)
    return Error{ErrorCode::kBusy, "scan " + scan_id + " is running: exports are made of scans that have ended"};
  return row;
}

ExportState Exports::state_of(const std::string& scan_id, const ExportSpec& spec, std::optional<std::uint64_t> size_bytes) const {
  const Key key{scan_id, spec.name()};
  ExportState state;
  state.format = spec.offer;
  state.shape = spec.shape;
  state.other_scan_id = spec.other_scan_id;
  if (running_ && running_->key == key && !running_->unwanted) {
    state.phase = ExportPhase::kRunning;
    state.done = running_->progress->done;
  } else if (size_bytes) {
    state.phase = ExportPhase::kReady;
    state.size_bytes = *size_bytes;
  } else if (const auto waiting = waiting_.find(key); waiting != waiting_.end()) {
    state.phase = ExportPhase::kQueued;
    state.words = waiting->second.words;
  } else if (const auto failed = failed_.find(key); failed != failed_.end()) {
    state.phase = ExportPhase::kFailed;
    state.words = failed->second.words;
  }
  return state;
}

// Exports with options that are ready, queued, running or failed.
std::vector<ExportSpec> Exports::shaped_exports(const std::string& scan_id, const std::vector<BlobInfo>& blobs) const {
  std::map<std::string, ExportSpec> found;
  const auto add_named = [&](const Key& key) {
    if (key.first != scan_id) return;
    if (const Result<ExportSpec> spec = export_spec_named(key.second); spec.ok() && !spec->shape.is_plain()) found[key.second] = *spec;
  };
  for (const BlobInfo& blob : blobs)
    if (const ExportSpec spec = shaped_export_of_file(blob.name); spec.offer) found[spec.name()] = spec;
  for (const auto& [key, work] : waiting_) add_named(key);
  for (const auto& [key, failed] : failed_) add_named(key);
  if (running_ && !running_->unwanted) add_named(running_->key);
  std::vector<ExportSpec> specs;
  for (const auto& [name, spec] : found) specs.push_back(spec);
  return specs;
}

Result<std::vector<ExportState>> Exports::list(const std::string& scan_id) {
  if (const Result<ScanRow> row = find_ended(scan_id); !row.ok()) return row.error();
  const Result<std::vector<BlobInfo>> blobs = blobs_.list(scan_id);
  if (!blobs.ok()) return blobs.error();
  const auto find = [&blobs](std::string_view name) {
    return std::find_if(blobs->begin(), blobs->end(), [name](const BlobInfo& info) { return info.name == name; });
  };
  const auto is_there = [&](std::string_view name) { return find(name) != blobs->end(); };
  std::vector<ExportSpec> specs;
  for (const ExportOffer& offer : export_offers()) {
    const std::vector<std::string> sources = sources_of(offer);
    if (is_there(offer.file) || std::any_of(sources.begin(), sources.end(), is_there)) specs.push_back({&offer, {}});
  }
  for (const ExportSpec& spec : shaped_exports(scan_id, *blobs)) specs.push_back(spec);
  std::vector<ExportState> states;
  for (const ExportSpec& spec : specs) {
    const auto blob = find(spec.file());
    states.push_back(state_of(scan_id, spec, blob == blobs->end() ? std::nullopt : std::optional<std::uint64_t>(blob->size_bytes)));
  }
  return states;
}

Result<ExportState> Exports::state(const std::string& scan_id, const std::string& name) {
  if (const Result<ScanRow> row = find_ended(scan_id); !row.ok()) return row.error();
  const Result<ExportSpec> spec = export_spec_named(name);
  if (!spec.ok()) return spec.error();
  return stored_state(scan_id, *spec);
}

Result<ExportState> Exports::stored_state(const std::string& scan_id, const ExportSpec& spec) const {
  const Result<std::uint64_t> size_bytes = blobs_.size_bytes(scan_id, spec.file());
  if (!size_bytes.ok() && size_bytes.error().code != ErrorCode::kNotFound) return size_bytes.error();
  return state_of(scan_id, spec, size_bytes.ok() ? std::optional<std::uint64_t>(*size_bytes) : std::nullopt);
}

Status Exports::check_shaped(const std::string& scan_id, const ExportSpec& spec) const {
  if (spec.shape.is_plain()) return Done{};
  const Result<std::vector<BlobInfo>> blobs = blobs_.list(scan_id);
  if (!blobs.ok()) return blobs.error();
  const std::vector<ExportSpec> there = shaped_exports(scan_id, *blobs);
  const bool is_there = std::any_of(there.begin(), there.end(), [&](const ExportSpec& one) { return one.name() == spec.name(); });
  if (is_there || there.size() < kMaxShapedExports) return Done{};
  return Error{ErrorCode::kBusy, "scan " + scan_id + " has " + std::to_string(there.size()) + " exports with options, of at most " +
                                     std::to_string(kMaxShapedExports) + ": remove one that nobody needs"};
}

Result<std::uint64_t> Exports::source_bytes(const std::string& scan_id, const ExportOffer& format) const {
  Result<std::uint64_t> size_bytes = Error{ErrorCode::kNotFound, ""};
  for (const std::string& source : sources_of(format)) {
    size_bytes = blobs_.size_bytes(scan_id, source);
    if (size_bytes.ok() || size_bytes.error().code != ErrorCode::kNotFound) return size_bytes;
  }
  return Error{ErrorCode::kNotFound, "scan " + scan_id + " has no " + sources_of(format).back()};
}

Status Exports::check_source(const std::string& scan_id, const ExportOffer& format) const {
  const Result<std::uint64_t> size_bytes = source_bytes(scan_id, format);
  if (!size_bytes.ok()) return size_bytes.error();
  if (format.kind != ExportKind::kPath && *size_bytes == format_ply({}).size())
    return Error{ErrorCode::kInvalidArgument, "the cloud of scan " + scan_id + " has no points: there is nothing to export"};
  return Done{};
}

Taken Exports::taken_by(const std::string& token_id) const {
  Taken taken{static_cast<std::int64_t>(waiting_.size() + running_count()), 0};
  for (const auto& [key, work] : waiting_) taken.own += work.token_id == token_id ? 1 : 0;
  if (running_ && running_->work.token_id == token_id) ++taken.own;
  return taken;
}

Status Exports::add(const ScanRow& scan, const ExportSpec& spec, const ExportRequest& asker, bool asked_for) {
  std::int64_t other_ended_at_ms = 0;
  for (const Status& status : {check_source(scan.id, *spec.offer), check_shaped(scan.id, spec)})
    if (!status.ok()) return status;
  if (spec.is_comparison()) {
    const Result<ScanRow> other = find_ended(spec.other_scan_id);
    if (!other.ok()) return other.error();
    other_ended_at_ms = other->finished_at_ms;
    for (const Status& status : {check_source(spec.other_scan_id, *spec.offer), check_comparisons(scan.id, spec)})
      if (!status.ok()) return status;
  }
  if (Status status = check_share(kExportShare, taken_by(asker.token_id), asker.is_admin, "exports that wait or are made"); !status.ok())
    return status;
  const Key key{scan.id, spec.name()};
  failed_.erase(key);
  waiting_[key] = {spec, asker.token_id, asked_for, scan.finished_at_ms, other_ended_at_ms, ++count_, {}, {}};
  begin_next();
  return Done{};
}

Status Exports::request(const ExportRequest& request) {
  const Result<ScanRow> row = find_ended(request.scan_id);
  if (!row.ok()) return row.error();
  const Result<ExportState> now = state(request.scan_id, request.format);
  return now.ok() ? request_spec(*row, {now->format, now->shape}, request) : Status(now.error());
}

Status Exports::request_spec(const ScanRow& scan, const ExportSpec& spec, const ExportRequest& asker) {
  const Result<ExportState> now = stored_state(scan.id, spec);
  if (!now.ok()) return now.error();
  const Key key{scan.id, spec.name()};
  if (const auto waiting = waiting_.find(key); waiting != waiting_.end()) waiting->second.asked_for = true;
  const bool there = now->phase == ExportPhase::kReady || now->phase == ExportPhase::kQueued || now->phase == ExportPhase::kRunning;
  if (there) return Done{};
  if (now->format->is_result) return Error{ErrorCode::kNotFound, "scan " + scan.id + " has no " + std::string(now->format->file)};
  if (stopping_) return Error{ErrorCode::kBusy, "the server is stopping"};
  if (running_ && running_->key == key) return Error{ErrorCode::kBusy, "it is just being stopped; try again in a moment"};
  return add(scan, spec, asker, true);
}

void Exports::make_mesh(const ScanRow& scan) {
  const ExportOffer* const format = find_export_offer(kViewerMesh);
  CHECK(format, "the viewer's mesh is a format");
  if (stopping_ || waiting_.contains({scan.id, std::string(format->name)})) return;
  if (const Status added = add(scan, {format, {}}, {scan.id, std::string(kViewerMesh), scan.token_id, false}, false); !added.ok())
    spdlog::info("scan {}: its mesh is not made by itself: {}", scan.id, added.error().message);
}

Status Exports::remove(const std::string& scan_id, const std::string& name) {
  const Result<ExportState> now = state(scan_id, name);
  if (!now.ok()) return now.error();
  if (now->format->is_result) return Error{ErrorCode::kInvalidArgument, name + " is a result of the scan and goes with it alone"};
  return remove_spec(scan_id, *now);
}

Status Exports::remove_spec(const std::string& scan_id, const ExportState& now) {
  const ExportSpec spec{now.format, now.shape, now.other_scan_id};
  const Key key{scan_id, spec.name()};
  if (now.phase == ExportPhase::kMissing)
    return Error{ErrorCode::kNotFound, "scan " + scan_id + " has no " + spec.file() + " and none is being made"};
  failed_.erase(key);
  waiting_.erase(key);
  if (running_ && running_->key == key) {
    running_->unwanted = true;
    running_->progress->stopped = true;
  }
  return now.phase == ExportPhase::kReady ? remove_files(scan_id, spec) : Status(Done{});
}

// False when the scan was deleted, or is running again to make its results anew.
bool Exports::is_still_wanted(const Key& key, const Work& work) const {
  if (!is_unchanged(key.first, work.ended_at_ms)) return false;
  return !work.spec.is_comparison() || is_unchanged(work.spec.other_scan_id, work.other_ended_at_ms);
}

bool Exports::is_unchanged(const std::string& scan_id, std::int64_t ended_at_ms) const {
  const Result<ScanRow> row = hooks_.find(scan_id);
  if (!row.ok()) return row.error().code != ErrorCode::kNotFound;
  return row->phase != ScanPhase::kRunning && row->finished_at_ms == ended_at_ms;
}

// Requests of people first; among these, the oldest of the token whose last turn is longest ago.
std::map<Exports::Key, Exports::Work>::iterator Exports::next_of() {
  const auto rank = [this](const Work& work) {
    const auto turn = last_turn_.find(work.token_id);
    return std::tuple(!work.asked_for, turn == last_turn_.end() ? 0 : turn->second, work.number);
  };
  auto next = waiting_.end();
  for (auto entry = waiting_.begin(); entry != waiting_.end(); ++entry)
    if (entry->second.begin_at <= now_ && (next == waiting_.end() || rank(entry->second) < rank(next->second))) next = entry;
  return next;
}

void Exports::begin_next() {
  while (!running_ && !stopping_) {
    const auto next = next_of();
    if (next == waiting_.end()) return;
    auto taken = waiting_.extract(next);
    if (is_still_wanted(taken.key(), taken.mapped())) begin(taken.key(), std::move(taken.mapped()));
  }
}

void Exports::begin(const Key& key, Work work) {
  if (last_turn_.size() > kMaxFailedExports) last_turn_.clear();  // most of these tokens no longer exist
  last_turn_[work.token_id] = ++count_;
  running_.emplace(Running{key, std::move(work)});
  if (const Status there = blobs_.availability(); !there.ok()) return wait_for_room(there.error());
  // The export is about as large as its source; it is checked again when its size is known.
  const Result<std::uint64_t> of_bytes = source_bytes(key.first, *running_->work.spec.offer);
  if (!of_bytes.ok()) return fail(of_bytes.error());
  if (const Status room = hooks_.check_disk(*of_bytes); !room.ok()) return wait_for_room(room.error());
  builder_keeps_ = true;
  hooks_.making([this, scan_id = key.first, spec = running_->work.spec, progress = running_->progress] {
    auto files = std::make_shared<Result<NamedFiles>>(Error{});
    try {
      *files = builder_.build(spec, scan_id, [&progress](double done) {
        progress->done = done;
        return !progress->stopped;
      });
    } catch (const std::exception& error) {
      *files = Error{ErrorCode::kIo, std::string("making it failed: ") + error.what()};  // out of memory, most likely
    }
    hooks_.network([this, files] { built(std::move(*files)); });
  });
}

void Exports::built(Result<NamedFiles> files) {
  if (running_->unwanted || stopping_ || !is_still_wanted(running_->key, running_->work)) return end_running();
  if (!files.ok()) return fail(files.error());
  std::uint64_t size_bytes = 0;
  for (const NamedFile& file : *files) size_bytes += file.bytes.size();
  if (const Status room = hooks_.check_disk(size_bytes); !room.ok()) return wait_for_room(room.error());
  put(std::make_shared<const NamedFiles>(*std::move(files)));
}

// The mark that a comparison leaves with the second scan is put first, so that no comparison is without one.
void Exports::put(const std::shared_ptr<const NamedFiles>& files) {
  hooks_.making([this, files, scan_id = running_->key.first, spec = running_->work.spec] {
    Status put = Done{};
    std::uint64_t size_bytes = 0;
    if (spec.is_comparison()) put = blobs_.put(spec.other_scan_id, comparison_mark(scan_id), scan_id + "\n");
    for (const NamedFile& file : *files) {
      if (put.ok()) put = blobs_.put(scan_id, file.name, file.bytes);
      size_bytes += file.bytes.size();
    }
    hooks_.network([this, put, size_bytes] { stored(put, size_bytes); });
  });
}

void Exports::stored(const Status& put, std::uint64_t size_bytes) {
  const auto& [scan_id, name] = running_->key;
  if (remove_of_deleted()) {
    spdlog::info("scan {}: {} is not kept, since its scan was deleted", scan_id, name);
  } else if (running_->unwanted || !is_still_wanted(running_->key, running_->work)) {
    if (const Status removed = remove_files(scan_id, running_->work.spec); !removed.ok())
      spdlog::warn("scan {}: {}", scan_id, removed.error().message);
  } else if (!put.ok()) {
    return wait_for_room(put.error());
  } else {
    spdlog::info("scan {}: {} is made, {} bytes", scan_id, name, size_bytes);
    hooks_.stored();
  }
  end_running();
}

// A full disk is temporary: the export is retried.
void Exports::wait_for_room(const Error& why) {
  Work work = std::move(running_->work);
  const bool away = !blobs_.availability().ok();
  work.words = away ? "the store of results does not answer; it is tried again once it does"
                    : why.message + "; it is tried again when there is room";
  work.pause = std::clamp(2 * work.pause, kFirstRoomPause, kLongestRoomPause);
  work.begin_at = now_ + work.pause;
  spdlog::warn("scan {}: {} waits: {}", running_->key.first, running_->key.second, why.message);
  const Key key = running_->key;
  const bool wanted = !running_->unwanted && !stopping_;
  end_running();
  if (wanted) waiting_[key] = std::move(work);
}

void Exports::fail(const Error& why) {
  spdlog::warn("scan {}: {} cannot be made: {}", running_->key.first, running_->key.second, why.message);
  // For an export that nobody requested, a missing source is not a failure.
  const bool nothing_to_make = why.code == ErrorCode::kInvalidArgument && !running_->work.asked_for;
  if (!nothing_to_make) failed_[running_->key] = {why.message, ++count_};
  if (failed_.size() > kMaxFailedExports)
    failed_.erase(
        std::min_element(failed_.begin(), failed_.end(), [](const auto& a, const auto& b) { return a.second.number < b.second.number; }));
  end_running();
}

// The next tick starts the next export.
void Exports::end_running() {
  idle_since_ = now_;
  running_.reset();
}

void Exports::tick(Clock::time_point now) {
  now_ = now;
  if (now - swept_at_ >= kSweepPeriod) {
    swept_at_ = now;
    std::erase_if(waiting_, [this](const auto& entry) { return !is_still_wanted(entry.first, entry.second); });
  }
  if (running_ && !is_still_wanted(running_->key, running_->work)) {
    running_->unwanted = true;
    running_->progress->stopped = true;
  }
  begin_next();
  if (running_ || !builder_keeps_ || now - idle_since_ < kKeepMesh) return;
  builder_keeps_ = false;
  hooks_.making([this] { builder_.forget(); });
}

void Exports::stop() {
  stopping_ = true;
  waiting_.clear();
  if (running_) running_->progress->stopped = true;
}

}  // namespace hermite
