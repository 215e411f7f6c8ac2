#include "core/base/frame_helpers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace hermite::frame_helpers_test {
namespace {

TEST(FrameHelpers, DoEachPieceOnce) {
  for (std::size_t count : {0u, 1u, 2u, 1000u}) {
    std::vector<int> done(count);
    in_parallel_of_frame(count, [&done](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(count, 1));
  }
}

TEST(FrameHelpers, AnExceptionComesOutAndEndsTheRest) {
  std::atomic<int> begun = 0;
  const auto work = [&begun](std::size_t) {
    ++begun;
    throw std::runtime_error("no room");
  };
  EXPECT_THROW(in_parallel_of_frame(1'000'000, work), std::runtime_error);
  EXPECT_LT(begun, 1'000'000);
  in_parallel_of_frame(3, [&begun](std::size_t) { begun = 0; });
  EXPECT_EQ(begun, 0) << "and the helpers go on";
}

// As several scans do, each of which has work within its work.
TEST(FrameHelpers, ServeManyThreadsAtOnce) {
  std::atomic<int> done = 0;
  {
    std::vector<std::jthread> scans;
    for (int scan = 0; scan < 20; ++scan)
      scans.emplace_back([&done] {
        for (int frame = 0; frame < 20; ++frame)
          in_parallel_of_frame(5, [&done](std::size_t) { in_parallel_of_frame(3, [&done](std::size_t) { ++done; }); });
      });
  }
  EXPECT_EQ(done, 20 * 20 * 5 * 3);
}

}  // namespace
}  // namespace hermite::frame_helpers_test
