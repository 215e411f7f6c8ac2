// Who does the jobs of recordings, from the settings: this process, or a Slurm cluster
// (server/slurm). Invalid options are SetupErrors, with a message that names the option.
#pragma once

#include <functional>
#include <memory>

#include "server/jobs/batch.h"
#include "server/service/service.h"
#include "server/slurm/slurm_cluster.h"
#include "server/store/store.h"

namespace hermite::server {

// nullptr: jobs are done in this process. Reads the jobs of the store.
std::unique_ptr<SlurmCluster> slurm_of(const ServiceOptions& options, Store& store);

// `cluster` outlives the options; nullptr as above.
BatchOptions batch_options(const ServiceOptions& options, const UploadLimits& uploads,
                           SlurmCluster* cluster);

// For recover_batch(), before there is a cluster.
std::function<bool(const JobRow&)> jobs_elsewhere(const ServiceOptions& options);

}  // namespace hermite::server
