#include "server/exports/export_queue.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <tuple>
#include <utility>

#include "core/base/step_back.h"
#include "server/exports/export_files.h"

namespace hermite::server {

namespace {

// As for scans whose results are made again (left_scans.cpp).
constexpr std::chrono::seconds kFirstRoomPause(5), kLongestRoomPause(3600);
// How long the last mesh stays in memory for another format.
constexpr std::chrono::minutes kKeepMesh(2);
// How often queued exports of deleted scans are removed.
constexpr std::chrono::seconds kSweepPeriod(5);

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

ExportQueue::ExportQueue(Blobs& blobs, const ExportHooks& hooks)
    : blobs_(blobs), hooks_(hooks), builder_(blobs, hooks.open_frames) {
  hooks_.making([] { step_back(); });  // threads that it starts inherit the priority
}

ExportQueue::Known ExportQueue::find(const ExportKey& key) const {
  if (running_ && running_->key == key && !running_->unwanted)
    return {ExportPhase::kRunning, running_->progress->done, ""};
  if (const auto waiting = waiting_.find(key); waiting != waiting_.end())
    return {ExportPhase::kQueued, 0, waiting->second.message};
  if (const auto failed = failed_.find(key); failed != failed_.end())
    return {ExportPhase::kFailed, 0, failed->second.message};
  return {};
}

std::vector<std::string> ExportQueue::names(const std::string& scan_id) const {
  std::vector<std::string> names;
  for (const auto& [key, work] : waiting_)
    if (key.scan_id == scan_id) names.push_back(key.name);
  for (const auto& [key, failed] : failed_)
    if (key.scan_id == scan_id) names.push_back(key.name);
  if (running_ && !running_->unwanted && running_->key.scan_id == scan_id)
    names.push_back(running_->key.name);
  return names;
}

Taken ExportQueue::taken_by(const std::string& token_id) const {
  Taken taken{static_cast<std::int64_t>(waiting_.size() + running_count()), 0};
  for (const auto& [key, work] : waiting_) taken.own += work.order.token_id == token_id ? 1 : 0;
  if (running_ && running_->work.order.token_id == token_id) ++taken.own;
  return taken;
}

void ExportQueue::add(ExportOrder order) {
  const ExportKey key{order.scan_id, order.spec.name()};
  failed_.erase(key);
  waiting_[key] = {std::move(order), ++count_, {}, {}};
  begin_next();
}

void ExportQueue::mark_requested(const ExportKey& key) {
  if (const auto waiting = waiting_.find(key); waiting != waiting_.end())
    waiting->second.order.is_requested = true;
}

void ExportQueue::drop(const ExportKey& key) {
  failed_.erase(key);
  waiting_.erase(key);
  if (!running_ || running_->key != key) return;
  running_->unwanted = true;
  running_->progress->stopped = true;
}

// False when the scan was deleted, or is running again to make its results anew.
bool ExportQueue::is_still_wanted(const ExportOrder& order) const {
  if (!is_unchanged(order.scan_id, order.ended_at_ms)) return false;
  return !order.spec.is_comparison() ||
         is_unchanged(order.spec.other_scan_id, order.other_ended_at_ms);
}

bool ExportQueue::is_unchanged(const std::string& scan_id, std::int64_t ended_at_ms) const {
  const Result<ScanRow> row = hooks_.find(scan_id);
  if (!row.ok()) return row.error().code != ErrorCode::kNotFound;
  return row->phase != ScanPhase::kRunning && row->finished_at_ms == ended_at_ms;
}

// Requests of people first; among these, the oldest of the token whose last turn is longest ago.
std::map<ExportKey, ExportQueue::Work>::iterator ExportQueue::next_of() {
  const auto rank = [this](const Work& work) {
    const auto turn = last_turn_.find(work.order.token_id);
    return std::tuple(!work.order.is_requested, turn == last_turn_.end() ? 0 : turn->second,
                      work.number);
  };
  auto next = waiting_.end();
  for (auto entry = waiting_.begin(); entry != waiting_.end(); ++entry)
    if (entry->second.begin_at <= now_ &&
        (next == waiting_.end() || rank(entry->second) < rank(next->second)))
      next = entry;
  return next;
}

void ExportQueue::begin_next() {
  while (!running_ && !stopping_) {
    const auto next = next_of();
    if (next == waiting_.end()) return;
    auto taken = waiting_.extract(next);
    if (is_still_wanted(taken.mapped().order)) begin(taken.key(), std::move(taken.mapped()));
  }
}

void ExportQueue::begin(const ExportKey& key, Work work) {
  // Most of these tokens no longer exist.
  if (last_turn_.size() > kMaxFailedExports) last_turn_.clear();
  last_turn_[work.order.token_id] = ++count_;
  running_.emplace(Running{key, std::move(work)});
  if (const Status there = blobs_.availability(); !there.ok()) return wait_for_room(there.error());
  // The export is about as large as its source; it is checked again when its size is known.
  const Result<std::uint64_t> of_bytes =
      source_bytes(blobs_, key.scan_id, *running_->work.order.spec.offer);
  if (!of_bytes.ok()) return fail(of_bytes.error());
  if (const Status room = hooks_.check_disk(*of_bytes); !room.ok())
    return wait_for_room(room.error());
  builder_keeps_ = true;
  hooks_.making([this, scan_id = key.scan_id, spec = running_->work.order.spec,
                 progress = running_->progress] {
    auto files = std::make_shared<Result<output::NamedFiles>>(Error{});
    try {
      *files = builder_.build(spec, scan_id, [&progress](double done) {
        progress->done = done;
        return !progress->stopped;
      });
    } catch (const std::exception& error) {
      // Out of memory, most likely.
      *files = Error{ErrorCode::kIo, std::string("making it failed: ") + error.what()};
    }
    hooks_.network([this, files] { built(std::move(*files)); });
  });
}

void ExportQueue::built(Result<output::NamedFiles> files) {
  if (running_->unwanted || stopping_ || !is_still_wanted(running_->work.order))
    return end_running();
  if (!files.ok()) return fail(files.error());
  std::uint64_t size_bytes = 0;
  for (const output::NamedFile& file : *files) size_bytes += file.bytes.size();
  if (const Status room = hooks_.check_disk(size_bytes); !room.ok())
    return wait_for_room(room.error());
  put(std::make_shared<const output::NamedFiles>(*std::move(files)));
}

void ExportQueue::put(const std::shared_ptr<const output::NamedFiles>& files) {
  hooks_.making([this, files, scan_id = running_->key.scan_id, spec = running_->work.order.spec] {
    const Status put = put_export(blobs_, scan_id, spec, *files);
    std::uint64_t size_bytes = 0;
    for (const output::NamedFile& file : *files) size_bytes += file.bytes.size();
    hooks_.network([this, put, size_bytes] { stored(put, size_bytes); });
  });
}

void ExportQueue::stored(const Status& put, std::uint64_t size_bytes) {
  const auto& [scan_id, name] = running_->key;
  if (remove_of_deleted()) {
    spdlog::info("scan {}: {} is not kept, since its scan was deleted", scan_id, name);
  } else if (running_->unwanted || !is_still_wanted(running_->work.order)) {
    if (const Status removed = remove_export(blobs_, scan_id, running_->work.order.spec);
        !removed.ok())
      spdlog::warn("scan {}: {}", scan_id, removed.error().message);
  } else if (!put.ok()) {
    return wait_for_room(put.error());
  } else {
    spdlog::info("scan {}: {} is made, {} bytes", scan_id, name, size_bytes);
    hooks_.stored();
  }
  end_running();
}

// A scan that was deleted while its export was written has got its folder again; the other scan of
// a comparison keeps nothing of it.
bool ExportQueue::remove_of_deleted() {
  const std::string& scan_id = running_->key.scan_id;
  const ExportSpec& spec = running_->work.order.spec;
  std::vector<std::string> deleted;
  for (const std::string& id : {scan_id, spec.other_scan_id})
    if (const Result<ScanRow> row = hooks_.find(id);
        !id.empty() && !row.ok() && row.error().code == ErrorCode::kNotFound)
      deleted.push_back(id);
  if (deleted.empty()) return false;
  if (spec.is_comparison())
    if (const Status removed = remove_export(blobs_, scan_id, spec); !removed.ok())
      spdlog::warn("scan {}: {}", scan_id, removed.error().message);
  for (const std::string& id : deleted) hooks_.remove_files_of_scan(id);
  return true;
}

// A full disk is temporary: the export is retried.
void ExportQueue::wait_for_room(const Error& why) {
  Work work = std::move(running_->work);
  const bool away = !blobs_.availability().ok();
  work.message = away ? "the store of results does not answer; it is tried again once it does"
                      : why.message + "; it is tried again when there is room";
  work.pause = std::clamp(2 * work.pause, kFirstRoomPause, kLongestRoomPause);
  work.begin_at = now_ + work.pause;
  spdlog::warn("scan {}: {} waits: {}", running_->key.scan_id, running_->key.name, why.message);
  const ExportKey key = running_->key;
  const bool wanted = !running_->unwanted && !stopping_;
  end_running();
  if (wanted) waiting_[key] = std::move(work);
}

void ExportQueue::fail(const Error& why) {
  spdlog::warn("scan {}: {} cannot be made: {}", running_->key.scan_id, running_->key.name,
               why.message);
  // For an export that nobody requested, a missing source is not a failure.
  const bool nothing_to_make =
      why.code == ErrorCode::kInvalidArgument && !running_->work.order.is_requested;
  if (!nothing_to_make) failed_[running_->key] = {why.message, ++count_};
  if (failed_.size() > kMaxFailedExports)
    failed_.erase(std::min_element(
        failed_.begin(), failed_.end(),
        [](const auto& a, const auto& b) { return a.second.number < b.second.number; }));
  end_running();
}

// The next tick starts the next export.
void ExportQueue::end_running() {
  idle_since_ = now_;
  running_.reset();
}

void ExportQueue::tick(Clock::time_point now) {
  now_ = now;
  if (now - swept_at_ >= kSweepPeriod) {
    swept_at_ = now;
    std::erase_if(waiting_,
                  [this](const auto& entry) { return !is_still_wanted(entry.second.order); });
  }
  if (running_ && !is_still_wanted(running_->work.order)) {
    running_->unwanted = true;
    running_->progress->stopped = true;
  }
  begin_next();
  if (running_ || !builder_keeps_ || now - idle_since_ < kKeepMesh) return;
  builder_keeps_ = false;
  hooks_.making([this] { builder_.forget(); });
}

void ExportQueue::stop() {
  stopping_ = true;
  waiting_.clear();
  if (running_) running_->progress->stopped = true;
}

}  // namespace hermite::server
