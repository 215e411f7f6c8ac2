// The scans that a load test has made, and how many viewers watch each that runs. Thread-safe.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace hermite::client {

class LoadScans {
 public:
  void begin(const std::string& scan_id);
  void end(const std::string& scan_id);  // it is given to viewers no more

  // Returns the running scan with the fewest viewers and counts one more; std::nullopt if none
  // runs.
  std::optional<std::string> take();
  void give_back(const std::string& scan_id);  // one viewer less

  std::vector<std::string> all() const;  // in the order in which they began

 private:
  mutable std::mutex mutex_;
  std::map<std::string, int> viewers_;  // of each that runs
  std::vector<std::string> all_;
};

}  // namespace hermite::client
