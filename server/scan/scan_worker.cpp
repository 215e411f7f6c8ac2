#include "server/scan/scan_worker.h"

#include <spdlog/spdlog.h>

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "server/scan/checkpoint_file.h"
#include "server/scan/scan_end.h"
#include "server/scan/scan_run.h"

namespace hermite::server {

struct ScanWorker::Impl {
  const ScanSetup setup;
  const ScanEvents events;
  FrameQueue queue;
  DurableFrames durable;
  std::mutex mutex;
  std::optional<Error> interrupted;  // guarded by mutex; why the scan ended early
  bool finishing = false;            // guarded by mutex
  std::optional<Abandon> abandoned;  // guarded by mutex
  std::atomic<bool> wants_mesh = false;
  std::thread thread;

  Impl(ScanSetup scan_setup, ScanEvents scan_events)
      : setup(std::move(scan_setup)),
        events(std::move(scan_events)),
        queue(setup.queue_capacity),
        durable(setup.replayed_frame_count) {}

  std::optional<Error> why_interrupted() {
    const std::lock_guard lock(mutex);
    return interrupted;
  }

  std::optional<Abandon> how_abandoned() {
    const std::lock_guard lock(mutex);
    return abandoned;
  }

  // An ended scan needs no checkpoint.
  void remove_checkpoint() const {
    if (const Status removed = setup.blobs->remove(setup.scan_id, kCheckpointName); !removed.ok())
      spdlog::warn("scan {}: its checkpoint is left: {}", setup.scan_id, removed.error().message);
  }

  ScanEnd run() try {
    ScanRun scan(setup, events, queue, durable, wants_mesh);
    scan.go_on();
    if (Status status = scan.take_frames(); !status.ok()) return failed_scan(status.error());
    if (const std::optional<Abandon> how = how_abandoned()) {
      if (*how == Abandon::kToGoOn) scan.leave();
      return {wire::ScanPhase::kRunning, {}, {}, {}};
    }
    Result<wire::Finished> results = scan.write();
    const std::optional<Error> reason = why_interrupted();
    if (!results.ok() && results.error().code == ErrorCode::kIo)
      return not_stored(*setup.blobs, setup.scan_id, reason, results.error());
    if (!results.ok())
      return failed_scan(reason ? in_context(reason->message, results.error()) : results.error());
    if (reason)
      return {wire::ScanPhase::kInterrupted, *reason, *std::move(results), reason->message};
    return {wire::ScanPhase::kFinished, {}, *std::move(results), scan.last_remark()};
  } catch (const SetupError& error) {
    return failed_scan(error.error());
  } catch (const std::exception& error) {
    // Out of memory, or an exception of a library: only this scan fails.
    return failed_scan({ErrorCode::kDevice, std::string("the scan failed: ") + error.what()});
  }
};

ScanWorker::ScanWorker(ScanSetup setup, ScanEvents events)
    : impl_(std::make_unique<Impl>(std::move(setup), std::move(events))) {
  impl_->thread = std::thread([impl = impl_.get()] {
    ScanEnd end = impl->run();
    if (end.phase != wire::ScanPhase::kRunning) impl->remove_checkpoint();
    // Frames are no longer taken and must not accumulate.
    impl->queue.close(true);
    impl->events.ended(std::move(end));
  });
}

ScanWorker::~ScanWorker() {
  impl_->queue.close(true);
  impl_->thread.join();
}

std::optional<wire::Frame> ScanWorker::push(wire::Frame frame) {
  return impl_->queue.push(std::move(frame));
}

void ScanWorker::finish() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->finishing = true;
  }
  impl_->queue.close(false);
}

void ScanWorker::abandon(Abandon how) {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->abandoned = how;
  }
  impl_->queue.close(true);
}

void ScanWorker::interrupt(const Error& reason, bool discard) {
  {
    const std::lock_guard lock(impl_->mutex);
    if (!impl_->interrupted && (!impl_->finishing || discard)) impl_->interrupted = reason;
  }
  impl_->queue.close(discard);
}

void ScanWorker::want_mesh(bool wanted) { impl_->wants_mesh = wanted; }

void ScanWorker::frames_durable(std::uint64_t count) { impl_->durable.advance(count); }

std::size_t ScanWorker::waiting_bytes() const { return impl_->queue.waiting_bytes(); }

}  // namespace hermite::server
