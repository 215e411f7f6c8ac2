// Who may run a scan now, and who waits for that: first come, first served, within the share of each token (shares.h). Belongs to the
// network thread.
//
// Places are counted, and measured: what a frame costs on this device decides how many scans a live one can have beside it, and what a
// scan takes of the device's memory how many there can be at all.
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

namespace hermite {

// Who may run so many scans may have as many more in line, and a few others find room beside seven who do.
inline constexpr Share kWaitingCameraShare{32, 4, 4};

struct PlaceRules {
  int max_running = 4;
  int max_running_per_token = 2;       // of tokens that may not administer
  int live_rate_hz = 5;                // frames a second that a live scan gets at least, or no other runs beside it; 0: whatever is left
  std::uint64_t gpu_memory_bytes = 0;  // for all scans together; 0: what the device has
};

// Every fourth place is kept for administrators: with fewer than four there would be too few left for others.
Share running_share(const PlaceRules& rules);

struct PlaceRequest {
  std::string token_id;  // empty: nobody's, as of a scan that an earlier server began
  bool is_admin = false;
  bool is_live = false;
};

class Places {
 public:
  using Ticket = std::uint64_t;

  explicit Places(PlaceRules rules) : rules_(rules) {}

  // kBusy, in words: there is no place.
  Status check(const PlaceRequest& request) const;
  // The same, and nobody is passed who waits and could begin as well.
  Status check_for_newcomer(const PlaceRequest& request) const;

  void began(const std::string& scan_id, const PlaceRequest& request) { running_[scan_id] = {request}; }
  void ended(const std::string& scan_id);
  std::optional<PlaceRequest> request_of(const std::string& scan_id) const;  // of one that runs

  // A frame of one of the scans was in work for so long.
  void frame_done(double work_s);

  // So much the scan takes of the device's memory, and so much there is for all; 0: nobody knows.
  void memory_measured(const std::string& scan_id, std::uint64_t taken_bytes, std::uint64_t device_bytes);

  // kBusy: the line is full, or the token's share of it. `tell` is called at once and by tell(); `begin` when the turn has come: the camera
  // has left the line then.
  Result<Ticket> wait(const PlaceRequest& request, std::function<void(const wire::Waiting&)> tell, std::function<void()> begin);
  void leave(Ticket ticket) { line_.erase(ticket); }

  void dismiss();  // there will be no more places: everybody's turn comes, to be told so
  void serve();    // lets begin whoever can; when a scan has ended
  // Everybody who waits, how long about. `remaining_s`: until each of the scans that run has ended, infinite where nobody knows.
  void tell(std::vector<double> remaining_s) const;

  std::size_t waiting_count() const { return line_.size(); }
  double frame_s() const { return frame_s_; }   // that a frame takes when no other scan runs; 0: none was seen yet
  std::uint64_t gpu_memory_bytes() const;       // for all scans together; 0: nobody knows, and none is refused for it
  std::uint64_t scan_gpu_memory_bytes() const;  // that a scan comes to; 0: none was seen yet

 private:
  struct Running {
    PlaceRequest request;
    std::uint64_t memory_bytes = 0, most_memory_bytes = 0;  // of the device, now and ever
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
  std::map<std::string, Running> running_;  // by scan
  std::map<Ticket, Waiter> line_;
  Ticket next_ticket_ = 0;
  double frame_s_ = 0;
  std::uint64_t device_memory_bytes_ = 0;
  double ended_memory_bytes_ = 0;  // mean of the most that scans took which have ended; 0: none has
};

}  // namespace hermite
