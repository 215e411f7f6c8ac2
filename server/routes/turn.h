// A bound on how much of one kind is under way at once. Thread-safe.
#pragma once

#include <atomic>

namespace hermite {

// One of at most `most` that may be under way at once, while it lives; `taken` counts those that live.
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

}  // namespace hermite
