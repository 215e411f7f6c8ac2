// What the server and a node tell each other, as JSON in files of the folder that they share. Pure
// functions; a file that is no such message is kCorruptData.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/jobs/executor.h"
#include "server/store/job_row.h"
#include "server/store/scan_row.h"

namespace hermite::server {

// A longer message is not read.
inline constexpr std::size_t kMaxNodeMessageBytes = std::size_t{1} << 20;
inline constexpr std::size_t kMaxNodeLines = 100;  // of the job's log, from one node

// What a node is to do: job.json.
struct NodeOrder {
  std::string name;                      // of the Slurm job
  JobRow job;                            // with the id of the scan
  std::uint64_t logged_frame_count = 0;  // of the scan that is processed again
  std::string device;                    // as for Pipeline
  int gpu_memory_mb = 0;                 // for the scan; 0: as much as there is
  int checkpoint_period_ms = 0;
  int min_free_disk_mb = 0;
};
std::string format_order(const NodeOrder& order);
Result<NodeOrder> parse_order(const std::string& text);

// How a run on a node has ended: outcome.json.
enum class NodeEnd {
  kFinished,
  kFailed,   // the recording is at fault, and would be again
  kStopped,  // by a signal; the next run goes on from its checkpoint
  kNoRoom,   // the disk had none; it is worth another attempt later
};
struct NodeOutcome {
  NodeEnd end = NodeEnd::kFailed;
  std::string words;                    // for the user, as of JobEnd
  std::vector<std::string> lines;       // for the log of the job
  ScanRow scan;                         // if finished
  std::uint64_t peak_memory_bytes = 0;  // of the process; 0: unknown
};
std::string format_outcome(const NodeOutcome& outcome);
Result<NodeOutcome> parse_outcome(const std::string& text);

// How far it is: progress.json.
std::string format_stage(const JobStage& stage);
Result<JobStage> parse_stage(const std::string& text);

}  // namespace hermite::server
