#include "server/routes/admin.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <string_view>
#include <utility>

#include "server/store/disk_space.h"

namespace hermite::server {

namespace {

constexpr std::chrono::seconds kTryAgainAfter(10);

HttpAnswer text_answer(int status, std::string body) {
  HttpAnswer answer;
  answer.status = status;
  answer.body = std::move(body);
  return answer;
}

std::string in_mb(std::uint64_t bytes) { return fmt::format("{} MB", bytes / 1'000'000); }

HttpAnswer show_readiness(const AdminWorld& world, const HttpRequest&) {
  const std::vector<std::string> reasons = reasons_not_ready(world);
  if (reasons.empty()) return text_answer(200, "ready\n");
  std::string message;
  for (const std::string& reason : reasons) message += fmt::format("not ready: {}\n", reason);
  return text_answer(503, std::move(message));
}

HttpAnswer show_metrics(const AdminWorld& world, const HttpRequest&) {
  Load load;
  world.scans.describe(load);
  if (const Result<std::map<JobState, int>> jobs = world.store.jobs.count(); jobs.ok())
    for (const auto& [state, count] : *jobs) load.jobs[name_of(state)] = count;
  load.disk_free_bytes = free_bytes(world.data_folder).ok() ? *free_bytes(world.data_folder) : 0;
  load.connections = world.connections.count();
  load.draining = world.draining;
  load.database_damaged = world.store_watch.damage().has_value();
  HttpAnswer answer = text_answer(200, world.metrics.text(load));
  answer.content_type = "text/plain; version=0.0.4; charset=utf-8";
  return answer;
}

HttpAnswer show_trace(const AdminWorld& world, const HttpRequest& request) {
  constexpr std::string_view kKey = "scan=";
  const std::string_view query = request.query;
  if (!query.starts_with(kKey))
    return error_answer(400,
                        {ErrorCode::kInvalidArgument, "the scan is missing: debug/trace?scan=ID"});
  Result<std::string> trace =
      world.scans.traces().chrome_json(std::string(query.substr(kKey.size())));
  if (!trace.ok()) return error_answer(404, trace.error());
  HttpAnswer answer = text_answer(200, *std::move(trace));
  answer.content_type = "application/json";
  return answer;
}

HttpAnswer show_health(const AdminWorld&, const HttpRequest&) { return text_answer(200, "ok\n"); }

struct AdminRoute {
  std::string_view path;
  HttpAnswer (*handle)(const AdminWorld&, const HttpRequest&);
};
constexpr AdminRoute kRoutes[] = {{"/healthz", show_health},
                                  {"/readyz", show_readiness},
                                  {"/metrics", show_metrics},
                                  {"/debug/trace", show_trace}};

void log_device(const pipeline::OpenedDevice& device) {
  spdlog::info("scans use device {}", device.name);
  if (!device.unused_gpu.empty()) spdlog::warn("{}", device.unused_gpu);
}

}  // namespace

DeviceWatch::DeviceWatch(std::string device) : device_(std::move(device)) { start(); }

void DeviceWatch::start() {
  started_ = std::chrono::steady_clock::now();
  trying_ = std::async(std::launch::async, [device = device_, is_first = !known_] {
    Result<pipeline::OpenedDevice> opened = pipeline::open_device(device);
    if (is_first && opened.ok()) log_device(*opened);
    return opened;
  });
}

std::optional<std::string> DeviceWatch::problem(bool scan_failed) {
  if (trying_.valid() && trying_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    known_ = trying_.get();
  const bool well = known_ && known_->ok();
  const bool try_again = known_ && (!well || scan_failed);
  if (try_again && !trying_.valid() &&
      std::chrono::steady_clock::now() - started_ >= kTryAgainAfter)
    start();
  if (!known_) return "the GPU is still being opened";
  if (!well) return "the GPU: " + known_->error().message;
  return std::nullopt;
}

std::vector<std::string> reasons_not_ready(const AdminWorld& world) {
  std::vector<std::string> reasons;
  if (world.draining) reasons.push_back("the server is ending");
  if (const Status status = world.store.check_writable(); !status.ok())
    reasons.push_back(status.error().message);
  if (world.store_watch.damage()) reasons.push_back("the database: " + *world.store_watch.damage());
  if (const Status status = check_takes_files(world.data_folder); !status.ok())
    reasons.push_back("the disk: " + status.error().message);
  const Result<std::uint64_t> free = free_bytes(world.data_folder);
  if (!free.ok())
    reasons.push_back(free.error().message);
  else if (*free < world.min_free_bytes)
    reasons.push_back(fmt::format("the disk: {} are free for {}, wanted are {} (min-free-disk)",
                                  in_mb(*free), world.data_folder, in_mb(world.min_free_bytes)));
  else if (const Status room = world.scans.room().check_disk(); !room.ok())
    reasons.push_back("the disk: " + room.error().message);
  if (const Status there = world.scans.blobs().availability(); !there.ok())
    reasons.push_back("the results: " + there.error().message);
  if (const std::optional<std::string> problem = world.device.problem(world.scans.device_failed()))
    reasons.push_back(*problem);
  return reasons;
}

HttpAnswer answer_admin(const AdminWorld& world, const HttpRequest& request) {
  if (request.method != "GET" && request.method != "HEAD") {
    HttpAnswer answer = error_answer(405, {ErrorCode::kUnsupported, "allowed here: GET, HEAD"});
    answer.allow = "GET, HEAD";
    return answer;
  }
  for (const AdminRoute& route : kRoutes) {
    if (route.path != request.path) continue;
    HttpAnswer answer = route.handle(world, request);
    answer.route = route.path;
    return answer;
  }
  return error_answer(
      404, {ErrorCode::kNotFound, "here are healthz, readyz, metrics and debug/trace?scan=ID"});
}

}  // namespace hermite::server
