#include "server/slurm/slurm_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>

namespace hermite::server {

namespace {

// The signal comes this long before the time limit: a checkpoint is written meanwhile. Slurm may be
// up to a minute early.
constexpr const char* kSignal = "--signal=B:TERM@60";
constexpr const char* kSqueueFormat =
    "JobID:|,Name:|,State:|,RestartCnt:|,exit_code:|,NodeList:|,Reason:|";
constexpr std::size_t kSqueueFields = 7;
constexpr std::size_t kMostSaidBytes = 300;

// What a program needs to find its libraries, its driver and its home. Nothing else of the server's
// environment leaves it, since secrets may be there.
constexpr std::array kExported = {
    "PATH", "HOME", "LANG", "LD_LIBRARY_PATH", "VK_ICD_FILENAMES", "VK_DRIVER_FILES"};

constexpr std::array kOverStates = {"COMPLETED",     "CANCELLED", "FAILED",    "TIMEOUT",
                                    "PREEMPTED",     "NODE_FAIL", "BOOT_FAIL", "DEADLINE",
                                    "OUT_OF_MEMORY", "REVOKED"};

std::string quoted_for_shell(const std::string& text) {
  std::string quoted = "'";
  for (const char letter : text)
    quoted += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return quoted + "'";
}

std::string exported_variables() {
  std::vector<std::string> names;
  for (const char* name : kExported)
    if (std::getenv(name)) names.emplace_back(name);
  return names.empty() ? "NONE" : fmt::format("{}", fmt::join(names, ","));
}

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t from = 0; from < line.size();) {
    const std::size_t end = std::min(line.find('|', from), line.size());
    fields.emplace_back(line.substr(from, end - from));
    from = end + 1;
  }
  return fields;
}

}  // namespace

std::vector<std::string> sbatch_command(const SlurmRequest& request) {
  std::vector<std::string> command = {"sbatch",
                                      "--parsable",
                                      "--requeue",
                                      "--open-mode=append",
                                      kSignal,
                                      "--export=" + exported_variables(),
                                      "--job-name=" + request.name,
                                      "--comment=" + request.comment,
                                      "--chdir=" + request.folder,
                                      std::string("--output=") + kOutputName,
                                      fmt::format("--mem={}", request.memory_mb)};
  if (!request.partition.empty()) command.push_back("--partition=" + request.partition);
  if (request.time_limit_min > 0)
    command.push_back(fmt::format("--time={}", request.time_limit_min));
  command.insert(command.end(), request.arguments.begin(), request.arguments.end());
  command.push_back(request.folder + "/" + kScriptName);
  return command;
}

std::vector<std::string> squeue_command(const std::vector<std::string>& names) {
  return {"squeue",
          "--me",
          "--noheader",
          "--states=all",
          fmt::format("--name={}", fmt::join(names, ",")),
          "--Format",
          kSqueueFormat};
}

std::vector<std::string> scancel_command(const std::vector<std::string>& names) {
  return {"scancel", "--quiet", "--me", fmt::format("--name={}", fmt::join(names, ","))};
}

std::string batch_script(const std::string& program, const std::string& folder) {
  return fmt::format("#!/bin/sh\nexec {} work {}\n", quoted_for_shell(program),
                     quoted_for_shell(folder));
}

Result<std::string> parse_job_number(std::string_view output) {
  const std::size_t end = std::min(output.find_first_not_of("0123456789"), output.size());
  const bool is_followed_well = end == output.size() || output[end] == '\n' || output[end] == ';';
  if (end == 0 || end > 20 || !is_followed_well)
    return Error{ErrorCode::kCorruptData, fmt::format("sbatch answered \"{}\", which is no number",
                                                      said_words(std::string(output)))};
  return std::string(output.substr(0, end));
}

std::vector<SlurmJob> parse_squeue(std::string_view output) {
  std::vector<SlurmJob> jobs;
  for (std::size_t from = 0; from < output.size();) {
    const std::size_t end = std::min(output.find('\n', from), output.size());
    const std::vector<std::string> fields = fields_of(output.substr(from, end - from));
    from = end + 1;
    if (fields.size() != kSqueueFields) continue;
    SlurmJob job{fields[0], fields[1], fields[2], 0, fields[4], fields[5], fields[6]};
    const std::string& count = fields[3];
    const auto [stop, error] =
        std::from_chars(count.data(), count.data() + count.size(), job.restarts);
    if (error == std::errc() && stop == count.data() + count.size() && job.restarts >= 0)
      jobs.push_back(std::move(job));
  }
  return jobs;
}

bool has_begun(const SlurmJob& job) {
  return job.state == "RUNNING" || job.state == "COMPLETING" || job.state == "SUSPENDED" ||
         job.state == "SIGNALING" || job.state == "STAGE_OUT" || job.state == "STOPPED";
}

bool is_over(const SlurmJob& job) {
  return std::find(kOverStates.begin(), kOverStates.end(), job.state) != kOverStates.end();
}

bool was_cancelled(const SlurmJob& job) { return job.state == "CANCELLED"; }
bool lacked_memory(const SlurmJob& job) { return job.state == "OUT_OF_MEMORY"; }

std::string wait_words(const SlurmJob& job) {
  if (has_begun(job) || is_over(job) || job.reason.empty() || job.reason == "None") return {};
  return "the cluster lets it wait: " + job.reason;
}

std::string end_words(const SlurmJob& job) {
  const std::string where = "job " + job.number + " of the cluster";
  const std::string on = job.nodes.empty() ? "" : " on " + job.nodes;
  if (was_cancelled(job))
    return where + " was cancelled there, with scancel or by an administrator";
  if (job.state == "TIMEOUT" || job.state == "DEADLINE")
    return where + on + " exceeded its time limit";
  if (lacked_memory(job)) return where + on + " needed more memory than it had asked for";
  if (job.state == "NODE_FAIL" || job.state == "BOOT_FAIL")
    return where + ": the node" + on + " failed";
  if (job.state == "PREEMPTED") return where + on + " had to give way to other jobs";
  if (job.state == "COMPLETED") return where + on + " ended without a result";
  return where + on + " failed, with exit status " + job.exit_code;
}

std::string said_words(const std::string& errors) {
  std::string said;
  for (std::size_t from = 0; from < errors.size();) {
    const std::size_t end = std::min(errors.find('\n', from), errors.size());
    std::string line = errors.substr(from, end - from);
    from = end + 1;
    if (const std::size_t mark = line.find("error: "); mark != std::string::npos)
      line.erase(0, mark + std::string_view("error: ").size());
    if (!line.empty()) said += (said.empty() ? "" : "; ") + line;
  }
  if (said.size() > kMostSaidBytes) said.resize(kMostSaidBytes);
  return said;
}

}  // namespace hermite::server
