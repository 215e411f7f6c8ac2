#include "server/service/places.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hermite {

namespace {

// The mean follows a change of the scene within a second or two of frames.
constexpr double kFrameWeight = 1.0 / 16;

Error busy(const std::string& words) { return {ErrorCode::kBusy, words}; }

}  // namespace

Status Places::check_server(const PlaceRequest& request) const {
  if (running_.size() >= static_cast<std::size_t>(rules_.max_running))
    return busy("this server runs at most " + std::to_string(rules_.max_running) + " scans at once");
  const bool any_live =
      request.is_live || std::any_of(running_.begin(), running_.end(), [](const auto& entry) { return entry.second.is_live; });
  const double together_s = frame_s_ * static_cast<double>(running_.size() + 1);
  if (any_live && !running_.empty() && together_s * rules_.live_rate_hz > 1)
    return busy("a frame takes " + std::to_string(std::lround(1000 * frame_s_)) +
                " ms on this server: with one scan more a live one would get fewer than " + std::to_string(rules_.live_rate_hz) +
                " frames a second");
  return Done{};
}

Status Places::check_token(const PlaceRequest& request) const {
  if (request.is_admin || request.token_id.empty()) return Done{};
  const auto own =
      std::count_if(running_.begin(), running_.end(), [&](const auto& entry) { return entry.second.token_id == request.token_id; });
  if (own < rules_.max_running_per_token) return Done{};
  return busy("this token may run at most " + std::to_string(rules_.max_running_per_token) + " scans at once");
}

Status Places::check(const PlaceRequest& request) const {
  if (Status status = check_server(request); !status.ok()) return status;
  return check_token(request);
}

Status Places::check_for_newcomer(const PlaceRequest& request) const {
  if (Status status = check(request); !status.ok()) return status;
  const auto before = std::count_if(line_.begin(), line_.end(), [&](const auto& entry) { return check_token(entry.second.request).ok(); });
  return before == 0 ? Status(Done{}) : busy(std::to_string(before) + " cameras wait for a place");
}

void Places::frame_done(double work_s) {
  // Scans share the device: with two of them a frame takes twice as long.
  const double alone_s = work_s / static_cast<double>(std::max<std::size_t>(1, running_.size()));
  frame_s_ = frame_s_ == 0 ? alone_s : frame_s_ + kFrameWeight * (alone_s - frame_s_);
}

Result<Places::Ticket> Places::wait(const PlaceRequest& request, std::function<void(const wire::Waiting&)> tell,
                                    std::function<void()> begin) {
  if (line_.size() >= kMaxWaitingCameras) return busy(std::to_string(line_.size()) + " cameras wait for a place already");
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
    // Who waits for his own scans to end keeps nobody waiting; who waits for the server's is not passed.
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
    waiter.tell({static_cast<std::uint32_t>(before), wait_s < kLongest_s ? static_cast<std::uint32_t>(std::ceil(wait_s)) : 0});
    ++before;
  }
}

}  // namespace hermite
