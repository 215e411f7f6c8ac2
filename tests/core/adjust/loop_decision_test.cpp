#include "core/adjust/loop_decision.h"

#include <gtest/gtest.h>

#include <string>

namespace hermite::adjust::loop_decision_test {
namespace {

const Camera kCamera{320, 240, 262, 262, 159.5, 119.5, 5000};

Rigid3 at(double x_m) {
  Rigid3 pose;
  pose.translation.x() = x_m;
  return pose;
}

// The camera has come back from three metres away to the first submap, which is inactive, and is 5
// cm off.
class LoopDecisions : public testing::Test {
 protected:
  LoopDecisions() {
    atlas.layout.current = open_submap(atlas, at(0.05), 0);
    atlas.graph.links.push_back({0, 1, at(0.05), 6, false});
    update_active(atlas, {});
    atlas.map.keyframes.resize(20);
    atlas.frame = 200;
  }

  LoopDecision::Verdict verified(double overlap, double true_x_m = 0) {
    return decision.verified(atlas, {at(0), {true, false}, true}, {at(true_x_m), overlap});
  }

  // Frames with keyframes.
  void go_on(int keyframes, int frames) {
    atlas.map.keyframes.resize(atlas.map.keyframes.size() + static_cast<std::size_t>(keyframes));
    atlas.frame += frames;
  }

  SubmapAtlas atlas = make_submap_atlas(kCamera);
  MappingCounts counts;
  LoopDecision decision;
};

TEST_F(LoopDecisions, WellSeenItIsClosedAtOnce) {
  const LoopDecision::Verdict verdict = verified(0.7);
  EXPECT_TRUE(verdict.is_possible);
  ASSERT_TRUE(verdict.close);
  EXPECT_EQ(verdict.close->link.from, 1u);
  EXPECT_EQ(verdict.close->link.to, 0u);
  EXPECT_TRUE(verdict.close->link.is_loop);
  EXPECT_NEAR(verdict.close->link.from_from_to.translation.x(), 0, 1e-12);
  EXPECT_FALSE(decision.is_pending());
}

TEST_F(LoopDecisions, ASmallCorrectionIsMadeAtOnce) { EXPECT_TRUE(verified(0.1, 0.0495).close); }

TEST_F(LoopDecisions, BeyondTheDriftOfTrackingIsImpossible) {
  const LoopDecision::Verdict verdict = verified(0.9, 1);
  EXPECT_FALSE(verdict.is_possible);
  EXPECT_FALSE(verdict.close);
}

TEST_F(LoopDecisions, AnotherComponentIsJoinedAtOnceHoweverFar) {
  atlas.graph.component[1] = 1;
  EXPECT_TRUE(verified(0.1, 5).close);
}

TEST_F(LoopDecisions, HardlySeenItWaitsForTheBestVerification) {
  EXPECT_TRUE(verified(0.2).is_possible);
  EXPECT_TRUE(decision.is_pending());
  const std::vector<LoopCandidate> again = decision.pending_candidate(atlas);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_NEAR(again[0].world_from_camera.translation.x(), 0, 1e-12);
  EXPECT_TRUE(again[0].by_appearance);
  go_on(1, 10);
  EXPECT_FALSE(verified(0.5, 0.01).close);
  go_on(1, 10);
  EXPECT_FALSE(verified(0.3, 0.02).close);
  EXPECT_FALSE(decision.take_due(atlas, counts));
  go_on(2, 20);
  const std::optional<VerifiedLoop> due = decision.take_due(atlas, counts);
  ASSERT_TRUE(due);
  EXPECT_EQ(due->overlap, 0.5);
  EXPECT_EQ(due->frame, 210);
  EXPECT_EQ(due->later_verifications, 2u);
  EXPECT_FALSE(decision.is_pending());
}

TEST_F(LoopDecisions, WithoutAnyLaterVerificationItIsDropped) {
  verified(0.2);
  go_on(3, 30);
  EXPECT_FALSE(decision.take_due(atlas, counts));
  EXPECT_FALSE(decision.is_pending());
  EXPECT_EQ(counts.unrepeated_loops, 1);
}

TEST_F(LoopDecisions, ACameraThatStandsStillClosesItInTheEnd) {
  verified(0.2);
  go_on(0, 44);
  EXPECT_FALSE(decision.take_due(atlas, counts));
  EXPECT_TRUE(decision.is_pending());
  go_on(0, 1);
  EXPECT_TRUE(decision.take_due(atlas, counts));
}

TEST_F(LoopDecisions, InAnotherComponentThePendingPlaceIsNoCandidate) {
  verified(0.2);
  enter_submap(atlas, open_submap(atlas, at(0), atlas.component_count++), at(0), {});
  EXPECT_TRUE(decision.pending_candidate(atlas).empty());
}

TEST_F(LoopDecisions, APendingLoopIsPartOfTheState) {
  verified(0.2);
  verified(0.1);
  ByteWriter saved;
  decision.save(saved);
  const std::string state = saved.take();
  LoopDecision restored, cut;
  ByteReader bytes(state), too_few(state);
  restored.restore(bytes, 2);
  ASSERT_TRUE(bytes.ok() && bytes.at_end());
  const std::optional<VerifiedLoop> loop = restored.take();
  ASSERT_TRUE(loop);
  EXPECT_EQ(loop->overlap, 0.2);
  EXPECT_EQ(loop->later_verifications, 1u);
  EXPECT_EQ(loop->link.from_from_to.matrix(), decision.take()->link.from_from_to.matrix());
  cut.restore(too_few, 1);
  EXPECT_FALSE(too_few.ok()) << "one of its submaps does not exist";
}

}  // namespace
}  // namespace hermite::adjust::loop_decision_test
