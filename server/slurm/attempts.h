// The folders that a server shares with the nodes of a cluster:
//
//   FOLDER/JOB/attempt-N/          one submission of a job; everything that a node may read or
//   write
//     job.json                     what is to be done (node_messages.h)
//     recording                    the upload: a hard link, or a copy where that is impossible
//     log/                         instead of it, the frames of the scan that is processed again
//     run.sh, output.txt           the script for Slurm, and what it has printed
//     number                       Slurm's number of the job, once it is known
//     closed                       exists: the server has given this attempt up
//     run-R/                       of one run: R is how often Slurm had put the job back before
//       progress.json              how far it is
//       scans/ID/                  the scan while it is made (data_directory.h)
//       result/                    the finished scan, renamed when it is complete
//       outcome.json               written last: how the run has ended
//
// Fencing. A node writes only into the folder of its own run, whose number Slurm gave it, and no
// two runs have the same. It starts nothing in an attempt that is closed. The server takes the
// result of one run only, which Slurm names as the last of the current attempt, and once it has a
// result or has given the attempt up it closes and removes the folder. So a node that comes back
// from the dead may still compute, but nobody reads what it writes.
//
// Going on. A run that finds a checkpoint of an earlier run of the same job takes a copy of it and
// of its frame log, and goes on from there; the result is the same as without the interruption.
// Without one, or if the checkpoint was made by another GPU, driver or program, it begins anew.
//
// Functions block on the shared disk. Errors are kIo, with a message, unless stated otherwise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/slurm/node_messages.h"

namespace hermite::server {

inline constexpr const char *kOrderName = "job.json", *kProgressName = "progress.json",
                            *kOutcomeName = "outcome.json", *kResultName = "result";

struct Attempt {
  std::string folder;
  int number = 0;
  std::string name;  // of the Slurm job
};

std::string run_folder(const std::string& attempt_folder, int run);

// Where the source of a job is for the server: an upload, or the frame log of a scan.
struct OrderSource {
  std::string path;
  std::string program;  // that the node is to run
};

// Makes the next attempt of a job. `order.name` is chosen here.
Result<Attempt> create_attempt(const std::string& job_folder, NodeOrder order,
                               const OrderSource& source);

// Returns the newest attempt; std::nullopt: there is none that is not closed.
std::optional<Attempt> open_attempt(const std::string& job_folder);
bool is_closed(const std::string& attempt_folder);
Status close_attempt(const std::string& attempt_folder);

// Slurm's number of the job; empty: not known.
std::string number_of(const Attempt& attempt);
Status keep_number(const Attempt& attempt, const std::string& number);

// All attempts of a job, the oldest first, and the jobs that have a folder.
std::vector<Attempt> attempts_of(const std::string& job_folder);
std::vector<std::string> jobs_in(const std::string& folder);

// The number of the newest run of an attempt; -1: none has begun.
int newest_run(const std::string& attempt_folder);

// What the server has written for the nodes. kNotFound, kCorruptData.
Result<NodeOrder> read_order(const std::string& attempt_folder);

// What a run has written; kNotFound: nothing yet. kCorruptData.
Result<NodeOutcome> read_outcome(const std::string& attempt_folder, int run);
Result<JobStage> read_progress(const std::string& attempt_folder, int run);

// The end of what the processes of an attempt have printed, of a bounded length; empty: nothing.
std::string last_words(const std::string& attempt_folder);

// The folder of the newest earlier run of this job that has left a checkpoint of the scan.
std::optional<std::string> run_to_go_on_from(const std::string& attempt_folder, int run,
                                             const std::string& scan_id);

// Gives a file another name, or copies it to another file system; copies are synced.
Status link_or_copy(const std::string& from, const std::string& to);
// The same for all files of a folder, which has no folders; `to` is made. kNotFound.
Status link_files(const std::string& from, const std::string& to);
// Copies them, so that neither changes with the other.
Status copy_files(const std::string& from, const std::string& to);

}  // namespace hermite::server
