// Limits how many operations of a kind run at once. Thread-safe.
#pragma once

#include <atomic>

namespace hermite::server {

// Claims one of `most` concurrent operations for its lifetime; `taken` counts the living objects.
// Without is_mine() there was no room.
class Turn {
 public:
  Turn(std::atomic<int>& taken, int most) : taken_(taken), is_mine_(taken.fetch_add(1) < most) {}
  ~Turn() { taken_.fetch_sub(1); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  bool is_mine() const { return is_mine_; }

 private:
  std::atomic<int>& taken_;
  const bool is_mine_;
};

}  // namespace hermite::server
