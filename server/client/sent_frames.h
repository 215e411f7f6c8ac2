// The numbered frames of a scan on their way to the server. One that the server has not said to be durable is kept, and sent again over the
// next connection if need be. Knows no socket. A single-threaded value.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "core/base/result.h"

namespace hermite {

class SentFrames {
 public:
  std::uint64_t numbered_count() const { return first_kept_ + kept_.size(); }  // and the number of the next new frame
  std::uint64_t sent_count() const { return sent_count_; }
  std::uint64_t first_kept() const { return first_kept_; }  // numbered_count() when none is kept
  std::size_t kept_count() const { return kept_.size(); }

  // The next new frame, which has the number numbered_count(), as a whole message.
  void add(std::string message) { kept_.push_back(std::move(message)); }

  // The frame to be sent now; null: all were. Valid until the next call.
  const std::string* next() const;
  void sent();  // CHECKs next()

  // The first `count` frames of the scan need not be kept any more.
  void durable(std::uint64_t count);

  // The server goes on with that frame. kIo in words: it is not kept, so that the scan cannot be gone on with.
  Status resume_at(std::uint64_t sequence);

 private:
  std::deque<std::string> kept_;
  std::uint64_t first_kept_ = 0;
  std::uint64_t sent_count_ = 0;
};

}  // namespace hermite
