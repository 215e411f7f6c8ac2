// A job whose upload is no recording but a cloud or a mesh: it becomes a finished scan with nothing behind it but its results.
//
// A thread of its own reads it and makes the files; everything else belongs to the network thread. The scan gets its row when all of its
// files are there: whoever dies before leaves nothing that anybody sees, and the job begins again.
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

namespace hermite {

class ImportJob : public JobWork {
 public:
  // Begins to work. `row` is of an upload, and has the id of the scan. `world` outlives this.
  ImportJob(const ScanJobWorld& world, JobRow row, JobEvents events);
  ~ImportJob() override;  // waits for what the thread is at
  ImportJob(const ImportJob&) = delete;
  ImportJob& operator=(const ImportJob&) = delete;

  void cancel() override;
  void stop() override;
  void tick() override {}

 private:
  struct Summary {
    std::vector<std::string> words;
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
  const std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  // what was posted for a job that is gone does nothing
  std::atomic<bool> stopped_ = false;
  std::uint64_t room_bytes_ = 0;  // that it needs on the disk
  bool cancelled_ = false;
  std::thread thread_;  // last: it uses the others
};

// Whether the bytes of an upload are those of a cloud or a mesh. False, too, when they cannot be read: the job says why.
bool is_import(const DataDirectory& data, const JobRow& row);

}  // namespace hermite
