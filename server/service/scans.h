// All scans of this server: those that run and those that have ended. Belongs to the network thread; only the scans' workers run beside it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/service/gate.h"
#include "server/service/live_scan.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"

namespace hermite {

// Encoded frames that one scan may hold in its queue. With 2048 x 2048 pixels this leaves a window of 3 frames.
inline constexpr std::size_t kMaxQueuedBytes = 128 * 1024 * 1024;

struct ScansOptions {
  std::string device;  // as for Pipeline
  int max_running = 4;
  std::uint32_t credit_window = 16;  // frames, at most
  int gpu_memory_mb = 0;             // of all scans together, in equal shares; 0: as much as there is
  int max_running_per_token = 2;     // of tokens that may not administer
  std::uint64_t storage_bytes = 0;   // for the files of all scans; 0: as much as there is
};

// What a camera is told of the scan it has started.
struct StartedScan {
  std::shared_ptr<LiveScan> scan;
  wire::Welcome welcome;
};

class Scans {
 public:
  // Runs a function on the network thread, soon. Callable from every thread.
  using Post = std::function<void(std::function<void()>)>;

  // Marks scans that a dead server left running as interrupted. `data` and `store` outlive this. Throws SetupError when the store cannot.
  Scans(ScansOptions options, const DataDirectory& data, Store& store, Post post);

  // kBusy: a quota is used up, in words, or the server is stopping. kInvalidArgument: a setting. kIo: the store or the disk.
  Result<StartedScan> start(const wire::StartScan& request, const Grant& grant);

  // kNotFound: no such scan. A scan that has ended is read from its files; one without files (failed) has nothing but its state.
  Result<std::shared_ptr<Audience>> watch(const std::string& scan_id);

  // With the present counts for running scans; newest first.
  Result<std::vector<ScanRow>> list();
  Result<ScanRow> find(const std::string& scan_id);

  // kBusy: it is running. kNotFound.
  Status remove(const std::string& scan_id);

  // Path of a result file of a scan that has ended. kNotFound: no such scan, or it has no such file.
  Result<std::string> file_of(const std::string& scan_id, const std::string& name);

  void stop();  // no new scans; those that run end as interrupted, with results
  std::size_t running_count() const { return running_.size(); }

 private:
  Status check_quotas(const Grant& grant) const;
  ScanEvents events_for(const std::shared_ptr<LiveScan>& scan) const;
  void ended(const ScanRow& row, const ScanEnd& end);
  ScanRow with_counts(ScanRow row) const;

  const ScansOptions options_;
  const DataDirectory& data_;
  Store& store_;
  const Post post_;
  std::map<std::string, std::shared_ptr<LiveScan>> running_;   // by id
  std::map<std::string, std::string> owners_;                  // of those that run: the tokens that started them
  std::map<std::string, std::weak_ptr<Audience>> read_again_;  // ended scans that someone is looking at
  bool stopping_ = false;
};

}  // namespace hermite
