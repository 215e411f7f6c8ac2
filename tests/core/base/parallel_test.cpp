#include "core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace hermite {
namespace {

TEST(InParallel, DoesEachPieceOnce) {
  std::vector<int> done(1000);
  in_parallel(done.size(), [&done](std::size_t i) { ++done[i]; });
  for (const int count : done) ASSERT_EQ(count, 1);
  in_parallel(0, [](std::size_t) { FAIL(); });
}

TEST(InParallel, AnExceptionComesOutAndEndsTheRest) {
  std::atomic<int> begun = 0;
  const auto work = [&begun](std::size_t) {
    ++begun;
    throw std::runtime_error("no room");
  };
  EXPECT_THROW(in_parallel(1'000'000, work), std::runtime_error);
  EXPECT_LT(begun, 1'000'000);
}

}  // namespace
}  // namespace hermite
