// The numbered frames of a scan that are being sent to the server. Each is kept until the server
// has reported it durable, and is sent again over the next connection if necessary. Uses no socket.
// A single-threaded value.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "core/base/result.h"

namespace hermite::client {

class SentFrames {
 public:
  // Number of the next new frame as well.
  std::uint64_t numbered_count() const { return first_kept_ + kept_.size(); }
  std::uint64_t sent_count() const { return sent_count_; }
  std::uint64_t first_kept() const { return first_kept_; }  // numbered_count() if none is kept
  std::size_t kept_count() const { return kept_.size(); }

  // Adds the next new frame, with the number numbered_count(), as a whole message.
  void add(std::string message) { kept_.push_back(std::move(message)); }

  // Returns the next frame to send; nullptr if all were sent. Valid until the next call.
  const std::string* next() const;
  void sent();  // CHECKs next()

  // The server has the first `count` frames on disk, so they need not be kept any more.
  void durable(std::uint64_t count);

  // The server continues with that frame. kIo, with a message: it is not kept any more, so that the
  // scan cannot be resumed.
  Status resume_at(std::uint64_t sequence);

 private:
  std::deque<std::string> kept_;
  std::uint64_t first_kept_ = 0;
  std::uint64_t sent_count_ = 0;
};

}  // namespace hermite::client
