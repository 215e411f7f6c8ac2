#include "server/client/activity_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "server/client/plural.h"
#include "server/client/printable.h"

namespace hermite::client {

namespace {

// "2024-05-01T12:00:00.123Z" -> "05-01 12:00"
std::string minute_of(const std::string& utc) {
  return utc.size() < 16 ? "-" : fmt::format("{} {}", utc.substr(5, 5), utc.substr(11, 5));
}

std::string gigabytes(double bytes) { return fmt::format("{:.1f}", bytes / 1e9); }

bool is_running(const JobReport& job) { return job.state == "running"; }

std::string rate_text(const std::optional<double>& frames_per_s) {
  return frames_per_s ? fmt::format("{:.1f}", *frames_per_s) : std::string("-");
}

std::string summary(const Activity& activity, const std::string& server, const std::string& now) {
  std::optional<double> frames_per_s;
  if (activity.scans.empty()) frames_per_s = 0;
  for (const RunningScan& row : activity.scans)
    if (row.frames_per_s) frames_per_s = frames_per_s.value_or(0) + *row.frames_per_s;
  std::string text = fmt::format("{}  {}  {} running, {} frames/s", server, now,
                                 plural(activity.scans.size(), "scan"), rate_text(frames_per_s));
  if (!activity.jobs) return text + "; the token may not see jobs";
  const auto running = static_cast<std::size_t>(
      std::count_if(activity.jobs->begin(), activity.jobs->end(), is_running));
  return text + fmt::format("; {} running, {} waiting", plural(running, "job"),
                            activity.jobs->size() - running);
}

std::string load_text(const ServerLoad& load) {
  std::string text = fmt::format("{}, {} waiting for a place",
                                 plural(static_cast<std::size_t>(load.viewers), "viewer"),
                                 plural(static_cast<std::size_t>(load.waiting_cameras), "camera"));
  text += "; GPU memory " + gigabytes(load.gpu_memory_bytes);
  if (load.gpu_memory_limit_bytes > 0) text += " of " + gigabytes(load.gpu_memory_limit_bytes);
  text += fmt::format(" GB; {} GB of disk free", gigabytes(load.disk_free_bytes));
  if (load.latency_s)
    text += fmt::format("; {:.0f} ms from a frame's arrival to its result", 1e3 * *load.latency_s);
  if (load.is_draining) text += "; the server is draining";
  if (load.is_database_damaged) text += "; THE DATABASE IS DAMAGED";
  return text;
}

// Titles are cut to 40 characters, so that a terminal of 80 columns shows what precedes the ids.
std::string scan_row(const std::string& rate, const std::string& waiting,
                     const std::string& dropped, const std::string& frames,
                     const std::string& begun) {
  return fmt::format("{:>8} {:>7} {:>7} {:>8}  {:<11}  ", rate, waiting, dropped, frames, begun);
}

std::string titled(const std::string& title, const std::string& id) {
  return fmt::format("{:<40.40}  {}", printable(title), printable(id));
}

std::string row_of(const RunningScan& row) {
  const auto text = [](std::int64_t count) { return std::to_string(count); };
  return scan_row(rate_text(row.frames_per_s), text(row.waiting_frames),
                  text(row.scan.frames_dropped), text(row.scan.frames_processed),
                  minute_of(row.scan.created_at)) +
         titled(row.scan.title, row.scan.id);
}

std::string job_row(const std::string& done, const std::string& stage) {
  return fmt::format("{:>8}  {:<24.24}  ", done, stage);
}

std::string row_of(const JobReport& job) {
  const std::string done = job.total > 0
                               ? fmt::format("{:.0f} %", 100 * static_cast<double>(job.done) /
                                                             static_cast<double>(job.total))
                               : "-";
  return job_row(done, printable(is_running(job) ? job.stage : job.state)) +
         titled(job.title, job.id) + (job.message.empty() ? "" : "  " + printable(job.message));
}

// Returns the first `columns` characters of UTF-8.
std::string cut(const std::string& line, std::size_t columns) {
  std::size_t characters = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool begins = (static_cast<unsigned char>(line[i]) & 0xc0) != 0x80;
    if (begins && characters++ == columns) return line.substr(0, i);
  }
  return line;
}

}  // namespace

std::string activity_text(const Activity& activity, const std::string& server,
                          const std::string& now, const TerminalSize& size) {
  std::vector<std::string> lines{summary(activity, server, now)};
  if (activity.load) lines.push_back(load_text(*activity.load));
  if (!activity.scans.empty()) {
    lines.emplace_back();
    lines.push_back(scan_row("FRAMES/S", "WAITING", "DROPPED", "FRAMES", "BEGUN (UTC)") +
                    titled("TITLE", "SCAN"));
    for (const RunningScan& row : activity.scans) lines.push_back(row_of(row));
  }
  if (activity.jobs && !activity.jobs->empty()) {
    lines.emplace_back();
    lines.push_back(job_row("DONE", "STAGE") + titled("TITLE", "JOB"));
    for (const JobReport& job : *activity.jobs)
      if (is_running(job)) lines.push_back(row_of(job));
    for (const JobReport& job : *activity.jobs)
      if (!is_running(job)) lines.push_back(row_of(job));
  }
  if (size.rows > 1 && lines.size() > size.rows) {
    const std::size_t missing = lines.size() - size.rows + 1;
    lines.resize(size.rows - 1);
    lines.push_back(fmt::format("... and {} more", plural(missing, "line")));
  }
  std::string text;
  for (const std::string& line : lines)
    text += (size.columns > 0 ? cut(line, size.columns) : line) + '\n';
  return text;
}

}  // namespace hermite::client
