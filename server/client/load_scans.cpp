#include "server/client/load_scans.h"

#include <algorithm>

namespace hermite::client {

void LoadScans::begin(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  viewers_.emplace(scan_id, 0);
  all_.push_back(scan_id);
}

void LoadScans::end(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  viewers_.erase(scan_id);
}

std::optional<std::string> LoadScans::take() {
  const std::lock_guard lock(mutex_);
  const auto fewest =
      std::min_element(viewers_.begin(), viewers_.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (fewest == viewers_.end()) return std::nullopt;
  ++fewest->second;
  return fewest->first;
}

void LoadScans::give_back(const std::string& scan_id) {
  const std::lock_guard lock(mutex_);
  if (const auto found = viewers_.find(scan_id); found != viewers_.end()) --found->second;
}

std::vector<std::string> LoadScans::all() const {
  const std::lock_guard lock(mutex_);
  return all_;
}

}  // namespace hermite::client
