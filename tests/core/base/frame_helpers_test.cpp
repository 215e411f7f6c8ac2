#include "core/base/frame_helpers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace hermite::frame_helpers_test {
namespace {

// As several scans do, each of which has work within its work.
TEST(FrameHelpers, ServeManyThreadsAtOnce) {
  std::atomic<int> done = 0;
  {
    std::vector<std::jthread> scans;
    for (int scan = 0; scan < 20; ++scan)
      scans.emplace_back([&done] {
        for (int frame = 0; frame < 20; ++frame)
          in_parallel_of_frame(5, [&done](std::size_t) {
            in_parallel_of_frame(3, [&done](std::size_t) { ++done; });
          });
      });
  }
  EXPECT_EQ(done, 20 * 20 * 5 * 3);
}

}  // namespace
}  // namespace hermite::frame_helpers_test
