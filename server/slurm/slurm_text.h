// What is said to Slurm's programs and what they answer. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace hermite::server {

// How this server uses the cluster.
struct SlurmRequest {
  std::string name;       // of the job; unique for each attempt
  std::string comment;    // for people who look at the queue
  std::string folder;     // of the attempt: working folder, and where the script and output are
  std::string partition;  // empty: the cluster's own choice
  std::vector<std::string> arguments;  // more arguments of sbatch
  int time_limit_min = 0;              // 0: that of the partition
  int memory_mb = 0;
};

inline constexpr const char *kScriptName = "run.sh", *kOutputName = "output.txt";

// The command that submits the job, and the one that asks for jobs of these names.
std::vector<std::string> sbatch_command(const SlurmRequest& request);
std::vector<std::string> squeue_command(const std::vector<std::string>& names);
std::vector<std::string> scancel_command(const std::vector<std::string>& names);

// The script of a job: becomes `PROGRAM work FOLDER`. Any characters may be in either.
std::string batch_script(const std::string& program, const std::string& folder);

// The number of the job from "12" or "12;cluster". kCorruptData.
Result<std::string> parse_job_number(std::string_view output);

// A job as the controller knows it.
struct SlurmJob {
  std::string number, name;
  std::string state;  // "PENDING", "RUNNING", ...
  int restarts = 0;   // how often Slurm has put it back into the queue
  std::string exit_code;
  std::string nodes;   // empty: none yet
  std::string reason;  // why it waits; "None": nothing to say
};

// Lines that are not from squeue_command() are left out.
std::vector<SlurmJob> parse_squeue(std::string_view output);

bool has_begun(const SlurmJob& job);  // a node works on it, or has just been told to
bool is_over(const SlurmJob& job);    // Slurm will not run it again
bool was_cancelled(const SlurmJob& job);

// What a person is told: why a job waits, empty if there is nothing to say; and why one has ended
// without a result.
std::string wait_words(const SlurmJob& job);
std::string end_words(const SlurmJob& job);
bool lacked_memory(const SlurmJob& job);

// One line of what a program has said, without "sbatch: error:" and of a bounded length.
std::string said_words(const std::string& errors);

}  // namespace hermite::server
