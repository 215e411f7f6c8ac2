// Admission of scans: which may run now, and which wait in a queue, in order of arrival and within
// the share of each token (shares.h). Belongs to the network thread.
//
// Admission depends on a count and on measurements: the processing time of a frame on this device
// decides how many scans may run beside a live one, and the device memory of a scan decides how
// many may run at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "proto/wire/messages.h"
#include "server/store/shares.h"

namespace hermite::server {

// Share of the queue: a token may have four cameras in it, and there is room for seven such tokens
// besides the places reserved for administrators.
inline constexpr Share kWaitingCameraShare{32, 4, 4};

struct PlaceRules {
  int max_running = 4;
  int max_running_per_token = 2;  // for tokens without the scope admin
  // Frames per second guaranteed to a live scan, or no other one is admitted beside it; 0: no
  // guarantee.
  int live_rate_hz = 5;
  std::uint64_t gpu_memory_bytes = 0;  // for all scans together; 0: what the device has
};

// Every fourth place is reserved for administrators; with fewer than four none is, since too few
// would be left for others.
Share running_share(const PlaceRules& rules);

struct PlaceRequest {
  std::string token_id;  // empty: none, for a scan that an earlier server began
  bool is_admin = false;
  bool is_live = false;
};

class Places {
 public:
  using Ticket = std::uint64_t;

  explicit Places(PlaceRules rules) : rules_(rules) {}

  // kBusy, with a message: there is no place.
  Status check(const PlaceRequest& request) const;
  // The same, but also kBusy while a scan waits that could begin as well, since a newcomer must not
  // overtake it.
  Status check_for_newcomer(const PlaceRequest& request) const;

  void began(const std::string& scan_id, const PlaceRequest& request) {
    running_[scan_id] = {request};
  }
  void ended(const std::string& scan_id);
  std::optional<PlaceRequest> request_of(const std::string& scan_id) const;  // of a running scan

  // Reports the processing time of a frame of one of the scans.
  void frame_done(double work_s);

  // Reports how much device memory a scan uses, and how much the device has for all; 0: unknown.
  void memory_measured(const std::string& scan_id, std::uint64_t taken_bytes,
                       std::uint64_t device_bytes);

  // Enters the queue. kBusy: the queue or the token's share of it is full. `tell` is called at once
  // and by tell(). `begin` is called when the turn has come, at which point the camera has left the
  // queue.
  Result<Ticket> wait(const PlaceRequest& request, std::function<void(const wire::Waiting&)> tell,
                      std::function<void()> begin);
  void leave(Ticket ticket) { line_.erase(ticket); }

  void dismiss();  // for shutdown: calls `begin` of all waiting cameras, so that each is refused
  void serve();    // calls `begin` of all that can begin; to be called when a scan has ended
  // Tells all waiting cameras about how long they will wait. `remaining_s`: until each of the
  // running scans ends; infinite if unknown.
  void tell(std::vector<double> remaining_s) const;

  std::size_t waiting_count() const { return line_.size(); }
  // Processing time of a frame if no other scan ran; 0: not measured yet.
  double frame_s() const { return frame_s_; }
  // Returns the memory for all scans together; 0: unknown, and no scan is refused for it.
  std::uint64_t gpu_memory_bytes() const;
  std::uint64_t scan_gpu_memory_bytes() const;  // expected for a scan; 0: not measured yet

 private:
  struct Running {
    PlaceRequest request;
    std::uint64_t memory_bytes = 0, most_memory_bytes = 0;  // device memory, current and peak
  };
  struct Waiter {
    PlaceRequest request;
    std::function<void(const wire::Waiting&)> tell;
    std::function<void()> begin;
  };
  Status check_server(const PlaceRequest& request) const;
  Status check_memory() const;
  Status check_token(const PlaceRequest& request) const;
  template <class Held>
  static Taken taken_of(const Held& held, const PlaceRequest& request);

  const PlaceRules rules_;
  std::map<std::string, Running> running_;  // by scan id
  std::map<Ticket, Waiter> line_;
  Ticket next_ticket_ = 0;
  double frame_s_ = 0;
  std::uint64_t device_memory_bytes_ = 0;
  double ended_memory_bytes_ = 0;  // mean of the peaks of ended scans; 0: none has ended
};

}  // namespace hermite::server
