#include "server/client/backoff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace hermite::client {
namespace {

using std::chrono::milliseconds;

TEST(Backoff, DoublesItsLimitUpToTheLongest) {
  constexpr int kClients = 400, kAttempts = 10;
  milliseconds longest[kAttempts] = {};
  std::set<milliseconds::rep> different;
  for (std::uint32_t seed = 0; seed < kClients; ++seed) {
    Backoff backoff(seed);
    for (milliseconds& limit : longest) {
      const milliseconds wait = backoff.next();
      EXPECT_GE(wait, milliseconds(0));
      limit = std::max(limit, wait);
      different.insert(wait.count());
    }
  }
  milliseconds limit = kFirstBackoff;
  for (const milliseconds seen : longest) {
    EXPECT_LE(seen, limit);
    EXPECT_GT(seen, limit * 9 / 10) << "the longest of 400 is near the limit";
    limit = std::min(2 * limit, kLongestBackoff);
  }
  EXPECT_GT(different.size(), 1000u) << "they do not all come back in the same moment";
}

}  // namespace
}  // namespace hermite::client
