// Does the work of one run on a node of a cluster: the part of a server that jobs need, in the
// folder of the run (attempts.h). So the scan is the one that the server would have made, with its
// frames, results and checkpoints, and its clouds and trajectories have the same bits.
//
// Rows are in a database in the node's own temporary folder, which is gone afterwards.
#pragma once

#include <atomic>
#include <string>

#include "core/base/result.h"
#include "server/slurm/node_messages.h"

namespace hermite::server {

// Returns how the run has ended, which is also in outcome.json, once everything that belongs to it
// is on the disk. `run`: how often Slurm had put the job back into its queue. `stop` becomes true
// when the node is to leave: then a checkpoint is written. Blocks for as long as the work takes.
// kBusy: the server has given the attempt up, or another process does this run. kNotFound,
// kCorruptData, kIo: there is no order here. Throws SetupError.
Result<NodeOutcome> run_on_node(const std::string& attempt_folder, int run,
                                const std::atomic<bool>& stop);

}  // namespace hermite::server
