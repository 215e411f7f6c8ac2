#include "server/access/places.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hermite::server {

namespace {

// The mean follows a change of the scene within one or two seconds of frames.
constexpr double kFrameWeight = 1.0 / 16;
// One large scan among small ones affects the admission of only the next few.
constexpr double kScanWeight = 1.0 / 4;

Error busy(const std::string& message) { return {ErrorCode::kBusy, message}; }

std::string in_mb(std::uint64_t bytes) {
  return fmt::format("{} MB", (bytes + 500'000) / 1'000'000);
}

// The first value becomes the mean.
void add_to_mean(double& mean, double value, double weight) {
  mean = mean == 0 ? value : mean + weight * (value - mean);
}

}  // namespace

Share running_share(const PlaceRules& rules) {
  return {rules.max_running, rules.max_running_per_token, rules.max_running / 4};
}

// Counts the entries of the queue, or the running scans, and those of the same token.
template <class Held>
Taken Places::taken_of(const Held& held, const PlaceRequest& request) {
  const auto own = std::count_if(held.begin(), held.end(), [&request](const auto& entry) {
    return entry.second.request.token_id == request.token_id;
  });
  return {static_cast<std::int64_t>(held.size()), own};
}

Status Places::check_server(const PlaceRequest& request) const {
  if (running_.size() >= static_cast<std::size_t>(rules_.max_running))
    return busy(fmt::format("this server runs at most {} scans at once", rules_.max_running));
  const bool any_live = request.is_live ||
                        std::any_of(running_.begin(), running_.end(),
                                    [](const auto& entry) { return entry.second.request.is_live; });
  const double together_s = frame_s_ * static_cast<double>(running_.size() + 1);
  if (any_live && !running_.empty() && together_s * rules_.live_rate_hz > 1)
    return busy(
        fmt::format("a frame takes {} ms on this server: with one scan more a live one would get "
                    "fewer than {} frames a second",
                    std::lround(1000 * frame_s_), rules_.live_rate_hz));
  return check_memory();
}

// Scans grow while they run, so each counts with the expected memory of a scan, or with its own if
// that is larger.
Status Places::check_memory() const {
  const std::uint64_t all = gpu_memory_bytes(), one_more = scan_gpu_memory_bytes();
  if (all == 0 || running_.empty()) return Done{};
  std::uint64_t taken = 0;
  for (const auto& [id, scan] : running_) taken += std::max(scan.memory_bytes, one_more);
  if (taken + one_more <= all) return Done{};
  return busy(fmt::format(
      "the scans that run come to {} of GPU memory and one more to {}: there are {} for all",
      in_mb(taken), in_mb(one_more), in_mb(all)));
}

Status Places::check_token(const PlaceRequest& request) const {
  Share share = running_share(rules_);
  if (request.token_id.empty()) share.per_token = share.in_all;  // belongs to no token
  return check_share(share, taken_of(running_, request), request.is_admin,
                     "scans that run at once");
}

Status Places::check(const PlaceRequest& request) const {
  if (Status status = check_server(request); !status.ok()) return status;
  return check_token(request);
}

Status Places::check_for_newcomer(const PlaceRequest& request) const {
  if (Status status = check(request); !status.ok()) return status;
  const auto before = std::count_if(line_.begin(), line_.end(), [&](const auto& entry) {
    return check_token(entry.second.request).ok();
  });
  return before == 0 ? Status(Done{}) : busy(fmt::format("{} cameras wait for a place", before));
}

void Places::frame_done(double work_s) {
  // Scans share the device: with two of them a frame takes twice as long.
  const double alone_s = work_s / static_cast<double>(std::max<std::size_t>(1, running_.size()));
  add_to_mean(frame_s_, alone_s, kFrameWeight);
}

std::optional<PlaceRequest> Places::request_of(const std::string& scan_id) const {
  const auto scan = running_.find(scan_id);
  return scan == running_.end() ? std::nullopt : std::optional(scan->second.request);
}

void Places::ended(const std::string& scan_id) {
  const auto scan = running_.find(scan_id);
  if (scan == running_.end()) return;
  // A scan that ended before it was measured says nothing about the next one.
  if (const std::uint64_t most = scan->second.most_memory_bytes; most > 0)
    add_to_mean(ended_memory_bytes_, static_cast<double>(most), kScanWeight);
  running_.erase(scan);
}

void Places::memory_measured(const std::string& scan_id, std::uint64_t taken_bytes,
                             std::uint64_t device_bytes) {
  device_memory_bytes_ = device_bytes;
  const auto scan = running_.find(scan_id);
  if (scan == running_.end()) return;
  scan->second.memory_bytes = taken_bytes;
  scan->second.most_memory_bytes = std::max(scan->second.most_memory_bytes, taken_bytes);
}

std::uint64_t Places::gpu_memory_bytes() const {
  return rules_.gpu_memory_bytes > 0 ? rules_.gpu_memory_bytes : device_memory_bytes_;
}

std::uint64_t Places::scan_gpu_memory_bytes() const {
  if (ended_memory_bytes_ > 0) return static_cast<std::uint64_t>(std::llround(ended_memory_bytes_));
  std::uint64_t most = 0;
  for (const auto& [id, scan] : running_) most = std::max(most, scan.most_memory_bytes);
  return most;
}

Result<Places::Ticket> Places::wait(const PlaceRequest& request,
                                    std::function<void(const wire::Waiting&)> tell,
                                    std::function<void()> begin) {
  if (Status status = check_share(kWaitingCameraShare, taken_of(line_, request), request.is_admin,
                                  "cameras that wait for a place");
      !status.ok())
    return status.error();
  tell({static_cast<std::uint32_t>(line_.size()), 0});
  line_[next_ticket_] = {request, std::move(tell), std::move(begin)};
  return next_ticket_++;
}

void Places::dismiss() {
  while (!line_.empty()) {
    const Waiter waiter = std::move(line_.begin()->second);
    line_.erase(line_.begin());
    waiter.begin();
  }
}

void Places::serve() {
  for (auto entry = line_.begin(); entry != line_.end();) {
    const Ticket ticket = entry->first;
    // A camera limited by the share of its own token, or by the places reserved for administrators,
    // is skipped and does not block others. A camera that waits for the server's capacity is not
    // overtaken.
    if (check_token(entry->second.request).ok()) {
      if (!check_server(entry->second.request).ok()) return;
      const Waiter waiter = std::move(entry->second);
      line_.erase(entry);
      waiter.begin();
    }
    entry = line_.upper_bound(ticket);
  }
}

void Places::tell(std::vector<double> remaining_s) const {
  constexpr double kLongest_s = 1e6;
  std::sort(remaining_s.begin(), remaining_s.end());
  std::size_t before = 0;
  for (const auto& [ticket, waiter] : line_) {
    const double wait_s = before < remaining_s.size() ? remaining_s[before] : kLongest_s;
    waiter.tell({static_cast<std::uint32_t>(before),
                 wait_s < kLongest_s ? static_cast<std::uint32_t>(std::ceil(wait_s)) : 0});
    ++before;
  }
}

}  // namespace hermite::server
