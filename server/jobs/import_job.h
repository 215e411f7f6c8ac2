// A job that imports an uploaded cloud or mesh: it becomes a finished scan that has results but no
// frames.
//
// A separate thread reads the upload and makes the files; everything else belongs to the network
// thread. The scan gets its database row once all of its files exist: if the server dies before,
// nothing is visible, and the job starts again.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/import_results.h"
#include "server/jobs/local_executor.h"
#include "server/jobs/scan_job.h"

namespace hermite::server {

class ImportJob : public JobWork {
 public:
  // Starts working. `row` refers to an upload and has the id of the new scan. `world` outlives
  // this.
  ImportJob(const ScanJobWorld& world, JobRow row, JobEvents events);
  ~ImportJob() override;  // waits for the thread
  ImportJob(const ImportJob&) = delete;
  ImportJob& operator=(const ImportJob&) = delete;

  void cancel() override;
  void stop() override;
  void tick() override {}

 private:
  struct Summary {
    std::vector<std::string> remarks;
    bool may_be_meshed = false;
  };
  // On the thread.
  void run(const Status& room);
  Result<Summary> import();
  void report(const char* stage);
  void on_network(std::function<void()> action);

  // On the network thread.
  void thread_ended(const Result<Summary>& summary);
  Status store_scan(const Summary& summary);

  const ScanJobWorld& world_;
  const JobRow row_;
  const JobEvents events_;
  // Functions posted for a destroyed job do nothing.
  const std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
  std::atomic<bool> stopped_ = false;
  std::uint64_t room_bytes_ = 0;  // needed on the disk
  bool cancelled_ = false;
  std::thread thread_;  // last: it uses the others
};

// Whether an upload is a cloud or a mesh, by its first bytes. False if it cannot be read; the job
// then reports the error.
bool is_import(const DataDirectory& data, const JobRow& row);

}  // namespace hermite::server
