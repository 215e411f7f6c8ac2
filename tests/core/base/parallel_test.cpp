#include "core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <vector>

#include "core/base/frame_helpers.h"

namespace hermite {
namespace {

using Work = std::function<void(std::size_t)>;
using Run = void (*)(std::size_t count, const Work& work);

// What holds for both ways to divide work.
class InParallel : public testing::TestWithParam<Run> {
 protected:
  void run(std::size_t count, const Work& work) const { GetParam()(count, work); }
};

TEST_P(InParallel, DoesEachPieceOnce) {
  for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
    std::vector<int> done(count);
    run(count, [&done](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(count, 1));
  }
}

TEST_P(InParallel, AnExceptionComesOutAndEndsTheRest) {
  std::atomic<int> begun = 0;
  const Work work = [&begun](std::size_t) {
    ++begun;
    throw std::runtime_error("no room");
  };
  EXPECT_THROW(run(1'000'000, work), std::runtime_error);
  EXPECT_LT(begun, 1'000'000);
  run(3, [&begun](std::size_t) { begun = 0; });
  EXPECT_EQ(begun, 0) << "and the next work is done";
}

INSTANTIATE_TEST_SUITE_P(ByNewThreadsAndByHelpers, InParallel,
                         testing::Values(Run{in_parallel<Work>}, Run{in_parallel_of_frame}));

}  // namespace
}  // namespace hermite
