#include "server/operations/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <mutex>

namespace hermite::server {

namespace {

using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;
using prometheus::Histogram;
using Buckets = Histogram::BucketBoundaries;

// From half a millisecond, the cheapest stage, to two seconds, which is far from live.
const Buckets kStageBuckets_s{0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.033,
                              0.05,   0.1,   0.2,   0.5,   1,    2};
const Buckets kMeshDelayBuckets_s{0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1, 1.5, 2, 3, 5, 10, 30};
const Buckets kRequestBuckets_s{0.0005, 0.001, 0.005, 0.01, 0.05, 0.1, 0.5, 1, 5, 30};

Family<Counter>& counter(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}
Family<Gauge>& gauge(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
}
Family<Histogram>& histogram(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

}  // namespace

struct Metrics::Impl {
  prometheus::Registry registry;
  // Totals maintained elsewhere, which never decrease.
  Counter& frames_received =
      counter(registry, "hermite_frames_received_total", "Frames that cameras have sent").Add({});
  Counter& frames_processed = counter(registry, "hermite_frames_processed_total",
                                      "Frames that went through the reconstruction")
                                  .Add({});
  Counter& frames_dropped =
      counter(registry, "hermite_frames_dropped_total",
              "Frames left out: of live scans for a newer one, or refused for their time stamp")
          .Add({});
  Counter& frames_unreadable =
      counter(registry, "hermite_frames_unreadable_total",
              "Frames whose images could not be decoded; they count as processed")
          .Add({});
  Counter& tracking_lost =
      counter(registry, "hermite_tracking_lost_total", "How often a camera was lost").Add({});
  Family<Histogram>& stages =
      histogram(registry, "hermite_frame_stage_seconds",
                "Time of one stage of one frame; encode: of what changed for viewers");
  Histogram& latency =
      histogram(registry, "hermite_frame_latency_seconds", "From a frame's arrival to its result")
          .Add({}, kStageBuckets_s);
  Histogram& mesh_delay =
      histogram(
          registry, "hermite_mesh_delay_seconds",
          "From a frame's arrival to the pieces of the live surface that show what it has changed")
          .Add({}, kMeshDelayBuckets_s);
  Counter& chunk_bytes = counter(registry, "hermite_chunk_encoded_bytes_total",
                                 "Encoded parts of the model, made once for all viewers")
                             .Add({});
  Family<Counter>& ended =
      counter(registry, "hermite_scans_ended_total", "Scans by how they ended");
  Family<Counter>& scans_rebuilt = counter(registry, "hermite_scans_rebuilt_total",
                                           "Scans of an earlier server that were gone on with, "
                                           "from a checkpoint or by replay of all frames");
  Counter& rebuilt_from_checkpoint = scans_rebuilt.Add({{"from", "checkpoint"}});
  Counter& rebuilt_by_replay = scans_rebuilt.Add({{"from", "replay"}});
  Family<Counter>& frames_rebuilt = counter(registry, "hermite_frames_rebuilt_total",
                                            "Their frames: out of the checkpoint, or replayed");
  Counter& frames_from_checkpoint = frames_rebuilt.Add({{"from", "checkpoint"}});
  Counter& frames_by_replay = frames_rebuilt.Add({{"from", "replay"}});
  Family<Histogram>& requests = histogram(registry, "hermite_http_request_duration_seconds",
                                          "From a whole request to a whole answer");
  Family<Counter>& closes = counter(registry, "hermite_websocket_closed_total",
                                    "Closed WebSockets by close code; 1006: by the other side");
  Counter& authentication_failures = counter(registry, "hermite_authentication_failures_total",
                                             "Requests and connections without a right token")
                                         .Add({});
  Family<Gauge>& scans = gauge(registry, "hermite_scans_running", "Scans by mode");
  Family<Gauge>& jobs =
      gauge(registry, "hermite_jobs",
            "Jobs by state; those that have ended count until they are forgotten");
  Gauge& waiting_cameras =
      gauge(registry, "hermite_waiting_cameras", "Cameras that wait for a scan of theirs to begin")
          .Add({});
  Gauge& viewers = gauge(registry, "hermite_viewers", "Connected viewers").Add({});
  Gauge& connections = gauge(registry, "hermite_connections",
                             "Open connections, those of the admin address left out")
                           .Add({});
  Gauge& credits =
      gauge(registry, "hermite_credits", "Frames that cameras may send at the moment").Add({});
  Gauge& frame_queue =
      gauge(registry, "hermite_queue_bytes", "Bytes that wait: frames for their worker")
          .Add({{"queue", "frames"}});
  Gauge& gpu_memory =
      gauge(registry, "hermite_gpu_memory_bytes", "Device memory of running scans").Add({});
  Gauge& gpu_memory_limit =
      gauge(registry, "hermite_gpu_memory_limit_bytes",
            "Device memory for all scans together; 0: not known, and none waits for it")
          .Add({});
  Gauge& scan_gpu_memory =
      gauge(registry, "hermite_scan_gpu_memory_bytes",
            "Device memory that a scan comes to, as measured; 0: none was seen yet")
          .Add({});
  Gauge& disk_free =
      gauge(registry, "hermite_disk_free_bytes", "Free space for the data folder").Add({});
  Gauge& draining =
      gauge(registry, "hermite_draining", "1 while the server takes no new scans and ends").Add({});
  Gauge& database_damaged = gauge(registry, "hermite_database_damaged",
                                  "1 when the last check has found the database damaged")
                                .Add({});
  std::mutex mutex;  // serialises text(), which reads those totals and then raises the counters
};

Metrics::Metrics(const std::string& version) : impl_(std::make_unique<Impl>()) {
  gauge(impl_->registry, "hermite_build_info", "Always 1").Add({{"version", version}}).Set(1);
}
Metrics::~Metrics() = default;

void Metrics::frame_done(const std::vector<Timeline::Stage>& stages, double latency_s,
                         bool unreadable, bool lost) {
  for (const Timeline::Stage& stage : stages) stage_done(stage);
  impl_->latency.Observe(latency_s);
  if (unreadable) impl_->frames_unreadable.Increment();
  if (lost) impl_->tracking_lost.Increment();
}

void Metrics::stage_done(const Timeline::Stage& stage) {
  impl_->stages.Add({{"stage", stage.name}}, kStageBuckets_s).Observe(stage.duration_ms / 1000);
}

void Metrics::mesh_made(const Timeline::Stage& work, double delay_s) {
  stage_done(work);
  impl_->mesh_delay.Observe(delay_s);
}

void Metrics::chunks_encoded(std::uint64_t bytes) {
  impl_->chunk_bytes.Increment(static_cast<double>(bytes));
}

void Metrics::scan_ended(const char* phase) { impl_->ended.Add({{"phase", phase}}).Increment(); }

void Metrics::scan_rebuilt(std::uint64_t checkpoint_frames, std::uint64_t replayed_frames) {
  (checkpoint_frames > 0 ? impl_->rebuilt_from_checkpoint : impl_->rebuilt_by_replay).Increment();
  impl_->frames_from_checkpoint.Increment(static_cast<double>(checkpoint_frames));
  impl_->frames_by_replay.Increment(static_cast<double>(replayed_frames));
}

void Metrics::request_answered(std::string_view route, int status, double duration_s) {
  impl_->requests
      .Add({{"route", std::string(route)}, {"code", std::to_string(status)}}, kRequestBuckets_s)
      .Observe(duration_s);
}

void Metrics::websocket_closed(int code) {
  impl_->closes.Add({{"code", std::to_string(code)}}).Increment();
}

void Metrics::authentication_failed() { impl_->authentication_failures.Increment(); }

std::string Metrics::text(const Load& load) {
  const std::lock_guard lock(impl_->mutex);
  const auto raise = [](Counter& counter, std::uint64_t total) {
    counter.Increment(static_cast<double>(total) - counter.Value());
  };
  raise(impl_->frames_received, load.frames_received);
  raise(impl_->frames_processed, load.frames_processed);
  raise(impl_->frames_dropped, load.frames_dropped);
  for (const auto& [mode, count] : load.scans) impl_->scans.Add({{"mode", mode}}).Set(count);
  for (const auto& [state, count] : load.jobs) impl_->jobs.Add({{"state", state}}).Set(count);
  impl_->waiting_cameras.Set(load.waiting_cameras);
  impl_->viewers.Set(load.viewers);
  impl_->connections.Set(load.connections);
  impl_->credits.Set(static_cast<double>(load.credits));
  impl_->frame_queue.Set(static_cast<double>(load.queue_bytes));
  impl_->gpu_memory.Set(static_cast<double>(load.gpu_memory_bytes));
  impl_->gpu_memory_limit.Set(static_cast<double>(load.gpu_memory_limit_bytes));
  impl_->scan_gpu_memory.Set(static_cast<double>(load.scan_gpu_memory_bytes));
  impl_->disk_free.Set(static_cast<double>(load.disk_free_bytes));
  impl_->draining.Set(load.draining ? 1 : 0);
  impl_->database_damaged.Set(load.database_damaged ? 1 : 0);
  return prometheus::TextSerializer().Serialize(impl_->registry.Collect());
}

}  // namespace hermite::server
