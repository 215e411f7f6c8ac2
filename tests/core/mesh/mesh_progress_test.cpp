#include "core/mesh/mesh_progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace hermite::mesh {
namespace {

TEST(ToldProgress, TellsTheShareAndNothingMoreOnceItIsStopped) {
  std::vector<double> told;
  const MeshProgress progress = [&](double done) {
    told.push_back(done);
    return done < 0.5;
  };
  ToldProgress counted(progress, 4);
  counted.add_one();
  EXPECT_FALSE(counted.stopped());
  counted.add_one();
  EXPECT_TRUE(counted.stopped());
  counted.add_one();
  EXPECT_THAT(told, testing::ElementsAre(0.25, 0.5));
}

TEST(ToldProgress, NobodyHasToListen) {
  const MeshProgress none;
  ToldProgress counted(none, 1);
  counted.add_one();
  EXPECT_FALSE(counted.stopped());
}

}  // namespace
}  // namespace hermite::mesh
