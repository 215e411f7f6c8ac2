#include "server/service/batch_setup.h"

#include <boost/asio/ip/host_name.hpp>
#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "server/slurm/slurm_work.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

bool is_slurm(const ServiceOptions& options) { return options.batch == "slurm"; }

// Absolute, since nodes start elsewhere.
std::string shared_folder(const ServiceOptions& options) {
  return fs::absolute(options.slurm_folder.empty() ? options.data_folder + "/slurm"
                                                   : options.slurm_folder)
      .lexically_normal()
      .string();
}

// By its machine and its data.
std::string name_of_server(const ServiceOptions& options) {
  return boost::asio::ip::host_name() + ":" +
         fs::absolute(options.data_folder).lexically_normal().string();
}

SlurmOptions slurm_options(const ServiceOptions& options) {
  SlurmOptions slurm;
  slurm.folder = shared_folder(options);
  if (!options.slurm_folder.empty()) slurm.owner = name_of_server(options);
  slurm.program = options.slurm_program;
  std::error_code error;
  if (slurm.program.empty()) slurm.program = fs::read_symlink("/proc/self/exe", error).string();
  if (error)
    throw SetupError({ErrorCode::kIo, "setting slurm-program is needed: " + error.message()});
  slurm.partition = options.slurm_partition;
  slurm.arguments = options.slurm_arguments;
  slurm.time_limit_min = options.slurm_time_limit_min;
  slurm.memory_mb = options.slurm_memory_mb;
  slurm.device = options.device;
  // The share that a scan of this server has: with another one the map could end elsewhere.
  slurm.gpu_memory_mb = options.gpu_memory_mb / options.max_scans;
  slurm.checkpoint_period_ms = options.checkpoint_period_ms;
  slurm.min_free_disk_mb = options.min_free_disk_mb;
  slurm.poll_period = std::chrono::milliseconds(options.slurm_poll_ms);
  return slurm;
}

}  // namespace

std::unique_ptr<SlurmCluster> slurm_of(const ServiceOptions& options, Store& store) {
  if (!is_slurm(options)) return nullptr;
  std::set<std::string> living;
  for (const JobState state : {JobState::kQueued, JobState::kRunning})
    for (const JobRow& row : or_throw(store.jobs.in_state(state))) living.insert(row.id);
  return std::make_unique<SlurmCluster>(slurm_options(options), living);
}

BatchOptions batch_options(const ServiceOptions& options, const UploadLimits& uploads,
                           SlurmCluster* cluster) {
  BatchOptions batch{options.job_workers, uploads, std::nullopt};
  if (!cluster) return batch;
  batch.others = {options.slurm_jobs,
                  [cluster](const ScanJobWorld& world, const JobRow& row, JobEvents events) {
                    return std::make_unique<SlurmWork>(*cluster, world, row, std::move(events));
                  },
                  [cluster](const std::string& job_id) { cluster->dismiss(job_id); }};
  return batch;
}

std::function<bool(const JobRow&)> jobs_elsewhere(const ServiceOptions& options) {
  if (!is_slurm(options)) return {};
  return [folder = shared_folder(options)](const JobRow& row) {
    return is_in_cluster(folder, row.id);
  };
}

}  // namespace hermite::server
