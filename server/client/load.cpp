#include "server/client/load.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

#include "server/client/load_camera.h"
#include "server/client/load_cleaning.h"
#include "server/client/load_machine.h"
#include "server/client/load_viewers.h"

namespace hermite::client {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLoadProgressPeriod(100);
constexpr std::size_t kKeptFrames_bytes = std::size_t{512} << 20;
// A camera's connection has a socket and what Asio needs to wait for it; removing scans and the
// sequence need some more.
constexpr std::uint64_t kFilesOfACamera = 6, kFilesOfAViewer = 1, kOtherFiles = 200;

// The threads of the cameras, which end by their clock.
class CameraThreads {
 public:
  CameraThreads(const LoadCameras& shared, const LoadPlan& plan)
      : shared_(shared), loads_(static_cast<std::size_t>(plan.cameras)) {
    running_ = plan.cameras;
    for (int i = 0; i < plan.cameras; ++i)
      threads_.emplace_back([this, i, delay = plan.ramp * i / plan.cameras] {
        loads_[static_cast<std::size_t>(i)] = run_load_camera(shared_, i + 1, delay);
        --running_;
      });
  }
  ~CameraThreads() { join(); }
  CameraThreads(const CameraThreads&) = delete;
  CameraThreads& operator=(const CameraThreads&) = delete;

  bool running() const { return running_ > 0; }
  std::vector<CameraLoad> join() {
    for (std::thread& thread : threads_)
      if (thread.joinable()) thread.join();
    return std::move(loads_);
  }

 private:
  const LoadCameras& shared_;
  std::vector<CameraLoad> loads_;
  std::atomic<int> running_{0};
  std::vector<std::thread> threads_;
};

// Waits until the time is over, or no camera goes on.
void wait_for_end(LoadClock& clock, const CameraThreads& cameras,
                  const std::function<void(bool)>& show) {
  while (clock.wish() == 0 && cameras.running()) {
    show(false);
    std::this_thread::sleep_for(kLoadProgressPeriod);
  }
}

double seconds_since(SteadyTime time) {
  return std::chrono::duration<double>(Clock::now() - time).count();
}

// All frames that a camera can send in the time, so that encoding them takes nothing from the
// server on the same machine.
void prepare_frames(LoadFrames& frames, const LoadPlan& plan, const LoadObserver& observer) {
  const auto most =
      static_cast<std::int64_t>(std::ceil(plan.time.count() * *plan.request.pacing.rate_hz));
  const std::int64_t count = std::min(most, frames.sequence().frame_count());
  frames.prepare(count, [&](std::int64_t done) {
    if (observer.on_progress) observer.on_progress({.prepared = done, .to_prepare = count});
    return observer.interrupt_count() == 0;
  });
}

// With viewers, while the cameras stream. Without what is measured before and after.
LoadResult put_load(LoadFrames& frames, const LoadPlan& plan, const LoadObserver& observer,
                    LoadScans& scans) {
  LoadResult result;
  LoadCounters counters;
  LoadClock clock(plan.time, observer.interrupt_count);
  const double cpu_before_s = process_cpu_s();
  const auto show = [&](bool finishing) {
    if (observer.on_progress)
      observer.on_progress({0, 0, seconds_since(clock.began()), counters.scanning, counters.waiting,
                            counters.watching, counters.answered, finishing});
  };
  LoadViewers viewers(
      {plan.request.server, plan.api.tls, plan.viewers, plan.ramp, plan.request.connect_patience},
      scans, counters.watching);
  const LoadCameras shared{plan.request, frames, scans, clock, counters};
  CameraThreads cameras(shared, plan);
  wait_for_end(clock, cameras, show);
  result.seconds = seconds_since(clock.began());
  result.interrupted = clock.interrupted();
  result.machine.cores_used = (process_cpu_s() - cpu_before_s) / result.seconds;
  result.viewers = viewers.stop();
  while (cameras.running()) {
    show(true);
    std::this_thread::sleep_for(kLoadProgressPeriod);
  }
  result.cameras = cameras.join();
  return result;
}

}  // namespace

Result<LoadResult> run_load(const dataset::Sequence& sequence, const LoadPlan& plan,
                            const LoadObserver& observer) {
  CHECK(plan.cameras >= 1 && plan.cameras <= kMaxLoadCameras, "the number of cameras");
  CHECK(plan.viewers >= 0 && plan.viewers <= kMaxLoadViewers, "the number of viewers");
  CHECK(plan.request.pacing.newest_wins && plan.request.pacing.rate_hz, "a load test is live");
  const std::uint64_t files = kFilesOfACamera * static_cast<std::uint64_t>(plan.cameras) +
                              kFilesOfAViewer * static_cast<std::uint64_t>(plan.viewers) +
                              kOtherFiles;
  if (Status status = allow_open_files(files); !status.ok()) return status.error();
  LoadFrames frames(sequence, kKeptFrames_bytes);
  prepare_frames(frames, plan, observer);
  LoadScans scans;
  LoadResult result = put_load(frames, plan, observer, scans);
  result.camera_count = plan.cameras;
  result.viewer_count = plan.viewers;
  result.rate_hz = *plan.request.pacing.rate_hz;
  result.machine.cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  result.machine.has_server_too = is_this_machine(plan.request.server);
  result.cleaning = clear_load_scans(plan.api, scans.all(), plan.keep,
                                     [&] { return observer.interrupt_count() > 1; });
  return result;
}

}  // namespace hermite::client
