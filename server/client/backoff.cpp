#include "server/client/backoff.h"

#include <algorithm>

namespace hermite::client {

std::chrono::milliseconds Backoff::next() {
  std::uniform_int_distribution<std::chrono::milliseconds::rep> any(0, limit_.count());
  const std::chrono::milliseconds wait(any(random_));
  limit_ = std::min(2 * limit_, kLongestBackoff);
  return wait;
}

}  // namespace hermite::client
