#include "core/base/step_back.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <thread>

namespace hermite {
namespace {

int own_priority() { return getpriority(PRIO_PROCESS, 0); }

TEST(StepBack, IsOfOneThread) {
  const int before = own_priority();
  int other = before;
  std::thread([&other] {
    step_back();
    other = own_priority();
  }).join();
  EXPECT_EQ(other, std::min(before + 10, 19));
  EXPECT_EQ(own_priority(), before);
}

}  // namespace
}  // namespace hermite
