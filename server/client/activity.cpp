#include "server/client/activity.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include "server/client/http_exchange.h"

namespace hermite::client {

namespace {

// The server lists a thousand scans at once.
constexpr std::size_t kNewest = 1000, kAll = 1'000'000;

double value_of(const std::map<std::string, double>& metrics, const char* name) {
  const auto found = metrics.find(name);
  return found == metrics.end() ? 0 : found->second;
}

// A scan that a new server rebuilds counts its frames anew.
double rate_per_s(std::int64_t frames, std::chrono::steady_clock::duration time) {
  return static_cast<double>(std::max<std::int64_t>(0, frames)) /
         std::chrono::duration<double>(time).count();
}

}  // namespace

std::map<std::string, double> metric_values(const std::string& text) {
  std::map<std::string, double> values;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    const std::size_t space = line.find(' ');
    if (space == std::string_view::npos || line[0] == '#') continue;
    const std::string_view name = line.substr(0, space), number = line.substr(space + 1);
    if (name.find('{') != std::string_view::npos) continue;
    double value = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error == std::errc{}) values[std::string(name)] = value;
  }
  return values;
}

ActivityReader::ActivityReader(ApiTarget target, std::optional<ServerUrl> metrics)
    : target_(std::move(target)), metrics_(std::move(metrics)) {}

// A scan that has run for long may be older than the newest thousand.
Result<std::vector<ScanSummary>> ActivityReader::running_scans() {
  Result<std::vector<ScanSummary>> scans = list_scans(target_, has_read_ ? kNewest : kAll);
  if (!scans.ok()) return scans;
  for (const auto& known : counted_) {
    const std::string& id = known.first;
    const auto is_it = [&id](const ScanSummary& scan) { return scan.id == id; };
    if (std::any_of(scans->begin(), scans->end(), is_it)) continue;
    Result<ScanSummary> scan = show_scan(target_, id);
    if (scan.ok())
      scans->push_back(*std::move(scan));
    else if (scan.error().code != ErrorCode::kNotFound)  // it was deleted
      return scan.error();
  }
  std::erase_if(*scans, [](const ScanSummary& scan) { return scan.state != "running"; });
  return scans;
}

Result<ServerLoad> ActivityReader::load() {
  const Result<std::string> text =
      accepted_body(*metrics_, nullptr, false, {"GET", "/metrics", {}, ""});
  if (!text.ok()) return Error{text.error().code, "the metrics: " + text.error().message};
  std::map<std::string, double> metrics = metric_values(*text);
  const auto value = [&metrics](const char* name) { return value_of(metrics, name); };
  const auto grown = [&](const char* name) { return value(name) - value_of(last_metrics_, name); };
  ServerLoad load;
  load.viewers = static_cast<std::int64_t>(value("hermite_viewers"));
  load.waiting_cameras = static_cast<std::int64_t>(value("hermite_waiting_cameras"));
  load.gpu_memory_bytes = value("hermite_gpu_memory_bytes");
  load.gpu_memory_limit_bytes = value("hermite_gpu_memory_limit_bytes");
  load.disk_free_bytes = value("hermite_disk_free_bytes");
  load.is_draining = value("hermite_draining") != 0;
  load.is_database_damaged = value("hermite_database_damaged") != 0;
  const double frames = grown("hermite_frame_latency_seconds_count"),
               time_s = grown("hermite_frame_latency_seconds_sum");
  // After a restart of the server the counters begin again.
  if (!last_metrics_.empty() && frames > 0 && time_s >= 0) load.latency_s = time_s / frames;
  last_metrics_ = std::move(metrics);
  return load;
}

Result<Activity> ActivityReader::read() {
  Result<std::vector<ScanSummary>> running = running_scans();
  if (!running.ok()) return running.error();
  const Clock::time_point now = Clock::now();
  Activity activity;
  std::map<std::string, Counted> counted;
  for (ScanSummary& scan : *running) {
    RunningScan row;
    row.waiting_frames = std::max<std::int64_t>(
        0, scan.frames_received - scan.frames_processed - scan.frames_dropped);
    if (const auto before = counted_.find(scan.id); before != counted_.end())
      row.frames_per_s =
          rate_per_s(scan.frames_processed - before->second.frames, now - before->second.at);
    counted[scan.id] = {now, scan.frames_processed};
    row.scan = std::move(scan);
    activity.scans.push_back(std::move(row));
  }
  counted_ = std::move(counted);
  has_read_ = true;
  UploadTarget of_jobs;
  of_jobs.server = target_.server;
  of_jobs.tls = target_.tls;
  Result<std::vector<JobReport>> jobs = job_reports(of_jobs);
  if (!jobs.ok() && jobs.error().code != ErrorCode::kUnauthorized) return jobs.error();
  if (jobs.ok()) {
    std::erase_if(*jobs, [](const JobReport& job) { return job.ended(); });
    activity.jobs = *std::move(jobs);
  }
  if (!metrics_) return activity;
  const Result<ServerLoad> load = this->load();
  if (!load.ok()) return load.error();
  activity.load = *load;
  return activity;
}

}  // namespace hermite::client
