#include "server/client/sent_frames.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/base/check.h"

namespace hermite::client {

const std::string* SentFrames::next() const {
  return sent_count_ < numbered_count()
             ? &kept_[static_cast<std::size_t>(sent_count_ - first_kept_)]
             : nullptr;
}

void SentFrames::sent() {
  CHECK(next(), "there is no frame to be sent");
  ++sent_count_;
}

void SentFrames::durable(std::uint64_t count) {
  // A frame that was not sent cannot be durable, whatever the server says.
  for (; first_kept_ < std::min(count, sent_count_); ++first_kept_) kept_.pop_front();
}

Status SentFrames::resume_at(std::uint64_t sequence) {
  if (sequence < first_kept_ || sequence > numbered_count())
    return Error{ErrorCode::kIo, fmt::format("the server wants to go on with frame {}, but here "
                                             "are only frames {} to {} (exclusive)",
                                             sequence, first_kept_, numbered_count())};
  sent_count_ = sequence;
  return Done{};
}

}  // namespace hermite::client
