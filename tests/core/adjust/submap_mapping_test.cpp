// The back end behind a front end that is played: poses with a drift that is known, and
// verification that sees what is true.
#include "core/adjust/submap_mapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/synthetic/synthetic_camera.h"

namespace hermite::adjust {
namespace {

// A third of a usual image is enough for features, and quick to render.
const Camera kCamera{320, 240, 262, 262, 159.5, 119.5, 5000};

// What verification aligns from: farther from the truth it does not come back.
constexpr double kReach_m = 0.15, kReach_rad = 0.2;

struct Step {
  Rigid3 world_from_camera;  // true
  frame::RgbdFrame frame;
};

// `count` frames, `apart` frames of 30 Hz from one to the next. The world is the camera at the
// beginning of the lap.
std::vector<Step> walk(synthetic::RoomScene scene, int first, int count, int apart) {
  const synthetic::SyntheticRoom room(scene);
  std::vector<Step> steps;
  for (int i = 0; i < count; ++i) {
    const double time_s = (first + i * apart) / 30.0;
    const Rigid3 pose = synthetic::synthetic_pose(time_s, 1, scene);
    synthetic::RoomView view = room.render(kCamera, pose);
    steps.push_back({inverse(synthetic::synthetic_pose(0, 1, scene)) * pose,
                     {time_s, std::move(view.depth), std::move(view.color)}});
  }
  return steps;
}

// Tracking that is off by one part of a hundred of every step and a third of a degree per metre,
// always the same way.
class Drift {
 public:
  explicit Drift(double scale = 1) : scale_(scale) {}
  Rigid3 next(const Rigid3& previous_from_camera) const {
    Vector6d error = Vector6d::Zero();
    const double way_m = previous_from_camera.translation.norm();
    error.head<3>() = 0.01 * scale_ * previous_from_camera.translation;
    error[4] = 0.006 * scale_ * way_m;
    return previous_from_camera * exp_se3(error);
  }

 private:
  double scale_;
};

class PlayedFrontEnd {
 public:
  PlayedFrontEnd(const AdjustOptions& options, double drift, bool believes_everything = false)
      : mapping(kCamera, options, CorrectionTime::kByFrames),
        drift_(drift),
        believes_everything_(believes_everything) {}

  void track(const Step& step) {
    const Rigid3 tracked = started_
                               ? mapping.layout().world_from_submap[submap_] * submap_from_camera_ *
                                     drift_.next(inverse(true_before_) * step.world_from_camera)
                               : step.world_from_camera;
    started_ = true;
    true_before_ = step.world_from_camera;
    submap_from_camera_ = inverse(mapping.layout().world_from_submap[submap_]) * tracked;
    const std::vector<LoopCandidate> candidates = mapping.observe(step.frame, tracked);
    note_new_submaps(step);
    for (const LoopCandidate& candidate : candidates) {
      ++offered;
      const std::optional<Rigid3> seen_from = is_blind ? std::nullopt : verify(candidate, step);
      if (seen_from && mapping.confirm(candidate, {*seen_from * off_by, overlap})) break;
    }
    settle();
  }

  // How the front end verifies a candidate: where the camera truly is, as the nearest of these
  // submaps stands in the map.
  std::optional<Rigid3> verify(const LoopCandidate& candidate, const Step& step) {
    if (believes_everything_) return candidate.world_from_camera;
    std::optional<Rigid3> best;
    double least = 1e300;
    for (std::uint32_t submap = 0; submap < candidate.submaps.size(); ++submap) {
      const Rigid3 true_submap_from_camera =
          inverse(true_world_from_submap[submap]) * step.world_from_camera;
      if (!candidate.submaps[submap] || length_of(true_submap_from_camera) >= least) continue;
      least = length_of(true_submap_from_camera);
      best = mapping.layout().world_from_submap[submap] * true_submap_from_camera;
    }
    if (!best) return std::nullopt;
    const Rigid3 off = inverse(candidate.world_from_camera) * *best;
    if (off.translation.norm() > kReach_m || angle_rad(off.rotation) > kReach_rad)
      return std::nullopt;
    return best;
  }

  // Largest distance of a submap from where it truly is.
  double worst_error_m() const {
    double worst = 0;
    const Rigid3 map_from_world =
        mapping.layout().world_from_submap[0] * inverse(true_world_from_submap[0]);
    for (std::size_t i = 0; i < true_world_from_submap.size(); ++i)
      worst = std::max(worst, (mapping.layout().world_from_submap[i].translation -
                               (map_from_world * true_world_from_submap[i]).translation)
                                  .norm());
    return worst;
  }

  MappingCounts counts() const { return mapping.counts(); }
  std::int64_t loops() const { return counts().loops(); }

  Rigid3 world_from_camera() const {
    return mapping.layout().world_from_submap[submap_] * submap_from_camera_;
  }
  void settle() {
    const Rigid3 camera = world_from_camera();
    submap_ = mapping.layout().current;
    submap_from_camera_ = inverse(mapping.layout().world_from_submap[submap_]) * camera;
  }
  void is_at(const Rigid3& world_from_camera, const Step& step) {
    submap_ = mapping.layout().current;
    submap_from_camera_ = inverse(mapping.layout().world_from_submap[submap_]) * world_from_camera;
    true_before_ = step.world_from_camera;
    note_new_submaps(step);
  }

  SubmapMapping mapping;
  std::vector<Rigid3> true_world_from_submap;
  int offered = 0;
  double overlap = 1;     // of its verifications
  Rigid3 off_by;          // and what they are off by
  bool is_blind = false;  // they see nothing that fits

 private:
  // A submap's frame is the camera that opened it.
  void note_new_submaps(const Step& step) {
    while (true_world_from_submap.size() < mapping.layout().world_from_submap.size())
      true_world_from_submap.push_back(true_world_from_submap.empty() ? Rigid3{}
                                                                      : step.world_from_camera);
    if (true_world_from_submap.size() == 1) true_world_from_submap[0] = Rigid3{};
  }

  Drift drift_;
  const bool believes_everything_;
  std::uint32_t submap_ = 0;
  Rigid3 submap_from_camera_, true_before_;
  bool started_ = false;
};

// Once round the circuit, and a bit of the second lap.
const std::vector<Step>& circuit() {
  static const std::vector<Step> steps = walk(synthetic::RoomScene::kLoop, 0, 86, 19);
  return steps;
}

AdjustOptions without_global() {
  AdjustOptions options;
  options.local_bundle_adjustment = true;
  options.global_bundle_adjustment = false;
  return options;
}

TEST(SubmapMapping, AStandingCameraOpensNothing) {
  PlayedFrontEnd front_end({}, 0);
  const std::vector<Step> steps = walk(synthetic::RoomScene::kLoop, 0, 1, 1);
  for (int i = 0; i < 20; ++i) front_end.track(steps[0]);
  EXPECT_EQ(front_end.counts().submaps, 1);
  EXPECT_EQ(front_end.counts().keyframes, 1);
  EXPECT_EQ(front_end.mapping.layout().correction_count, 0u);
}

TEST(SubmapMapping, GoingToAndFroOpensNoMoreThanGoingThere) {
  const std::vector<Step> steps = walk(synthetic::RoomScene::kLoop, 0, 10, 10);
  PlayedFrontEnd front_end({}, 0);
  for (const Step& step : steps) front_end.track(step);
  const std::int64_t submaps = front_end.counts().submaps, keyframes = front_end.counts().keyframes;
  EXPECT_GE(submaps, 3);
  for (int i = 8; i >= 0; --i) front_end.track(steps[static_cast<std::size_t>(i)]);
  for (const Step& step : steps) front_end.track(step);
  EXPECT_LE(front_end.counts().submaps, submaps + 1);
  EXPECT_LE(front_end.counts().keyframes, keyframes + 2);
}

TEST(SubmapMapping, ACircuitIsClosedByLandmarksAndStraightenedByDepth) {
  AdjustOptions by_landmarks;
  by_landmarks.depth_links = false;
  PlayedFrontEnd open(without_global(), 1), closed(by_landmarks, 1), straight({}, 1);
  for (PlayedFrontEnd* front_end : {&open, &closed, &straight}) {
    for (const Step& step : circuit()) front_end->track(step);
    front_end->mapping.finish();
  }
  EXPECT_EQ(open.loops(), 0);
  EXPECT_GE(closed.loops(), 1);
  EXPECT_EQ(closed.counts().contradicting_loops, 0);
  RecordProperty("open_mm", static_cast<int>(1000 * open.worst_error_m()));
  RecordProperty("closed_mm", static_cast<int>(1000 * closed.worst_error_m()));
  RecordProperty("straight_mm", static_cast<int>(1000 * straight.worst_error_m()));
  EXPECT_GT(open.worst_error_m(), 0.05) << "nothing to correct";
  EXPECT_LT(closed.worst_error_m(), open.worst_error_m() / 3);
  EXPECT_LT(straight.worst_error_m(), 0.75 * closed.worst_error_m());
}

TEST(SubmapMapping, WithoutALoopNothingIsLaidAnew) {
  PlayedFrontEnd front_end({}, 1);
  for (std::size_t i = 0; i < 20; ++i) front_end.track(circuit()[i]);
  const std::vector<Rigid3> before = front_end.mapping.layout().world_from_submap;
  front_end.mapping.finish();
  ASSERT_EQ(front_end.loops(), 0);
  const std::vector<Rigid3>& after = front_end.mapping.layout().world_from_submap;
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(after[i].matrix(), before[i].matrix());
}

// Until a place is well in view, verifications are off, and the last one is not the best.
TEST(SubmapMapping, ALoopIsMeasuredWhereMostOfThePlaceIsInView) {
  PlayedFrontEnd front_end({}, 1);
  front_end.overlap = 0.2;
  front_end.off_by.translation.y() = 0.03;
  std::size_t next = 0;
  const auto was_verified_again = [&] { return front_end.offered > 0; };
  while (next < circuit().size() && !was_verified_again()) front_end.track(circuit()[next++]);
  ASSERT_TRUE(was_verified_again());
  EXPECT_EQ(front_end.loops(), 0) << "a first verification is not enough";
  EXPECT_EQ(front_end.mapping.layout().correction_count, 0u);
  front_end.overlap = 0.5;
  front_end.off_by = Rigid3{};
  front_end.track(circuit()[next++]);
  front_end.overlap = 0.4;
  front_end.off_by.translation.y() = 0.03;
  while (next < circuit().size() && front_end.loops() == 0) front_end.track(circuit()[next++]);
  EXPECT_EQ(front_end.loops(), 1) << "nor waited for for ever";
  EXPECT_EQ(front_end.mapping.layout().closure_count, 1u);
  const Rigid3& truth = circuit()[next - 1].world_from_camera;
  EXPECT_LT((front_end.world_from_camera().translation - truth.translation).norm(), 0.015)
      << "by the verification that saw most";
}

TEST(SubmapMapping, ALoopThatNoLaterLookRepeatsIsNotBelieved) {
  PlayedFrontEnd front_end({}, 1);
  front_end.overlap = 0.2;
  std::size_t next = 0;
  while (next < circuit().size() && front_end.offered == 0) front_end.track(circuit()[next++]);
  front_end.is_blind = true;
  while (next < circuit().size() && front_end.counts().unrepeated_loops == 0)
    front_end.track(circuit()[next++]);
  EXPECT_EQ(front_end.counts().unrepeated_loops, 1);
  EXPECT_EQ(front_end.loops(), 0);
  EXPECT_EQ(front_end.mapping.layout().correction_count, 0u);
}

TEST(SubmapMapping, ALoopThatWaitsIsClosedAtTheEnd) {
  PlayedFrontEnd front_end({}, 1);
  front_end.overlap = 0.2;
  for (std::size_t i = 0; i < circuit().size() && front_end.offered == 0; ++i)
    front_end.track(circuit()[i]);
  ASSERT_EQ(front_end.loops(), 0);
  const double before_m = front_end.worst_error_m();
  front_end.mapping.finish();
  EXPECT_EQ(front_end.loops(), 1);
  EXPECT_LT(front_end.worst_error_m(), before_m / 2);
}

TEST(SubmapMapping, ALoopThatWaitsIsPartOfTheState) {
  PlayedFrontEnd front_end({}, 1);
  front_end.overlap = 0.2;
  for (std::size_t i = 0; i < circuit().size() && front_end.offered == 0; ++i)
    front_end.track(circuit()[i]);
  ByteWriter saved;
  front_end.mapping.save(saved);
  const std::string state = saved.take();
  SubmapMapping restored(kCamera, {}, CorrectionTime::kByFrames);
  ByteReader bytes(state);
  restored.restore(bytes);
  ASSERT_TRUE(bytes.ok() && bytes.at_end());
  for (SubmapMapping* mapping : {&front_end.mapping, &restored}) mapping->finish();
  EXPECT_EQ(restored.counts(), front_end.mapping.counts());
  EXPECT_EQ(restored.layout().closure_count, 1u);
  const std::vector<Rigid3>& poses = front_end.mapping.layout().world_from_submap;
  ASSERT_EQ(restored.layout().world_from_submap.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_EQ(restored.layout().world_from_submap[i].matrix(), poses[i].matrix());
}

// Stands still after the lap, and closes a loop in every fourth frame, each two millimetres beside
// the last: an adjustment takes longer.
class LoopsInARow : public testing::Test {
 protected:
  LoopsInARow() {
    for (const Step& step : circuit()) front_end.track(step);
    for (int i = 0; i < 60; ++i) front_end.track(circuit().back());  // and nothing runs any more
  }

  void close_loops(int frames) {
    const Rigid3 first_from_camera =
        inverse(front_end.mapping.layout().world_from_submap[0]) * front_end.world_from_camera();
    for (int i = 0; i < frames; ++i) {
      front_end.track(circuit().back());
      if (i % 4 != 0) continue;
      LoopCandidate candidate{front_end.world_from_camera(),
                              std::vector<bool>(front_end.mapping.layout().is_active.size(), false),
                              false};
      candidate.submaps[0] = true;
      Rigid3 seen_from = front_end.mapping.layout().world_from_submap[0] * first_from_camera;
      seen_from.translation.x() += i % 8 == 0 ? 0.002 : -0.002;
      const std::int64_t loops = front_end.loops();
      ASSERT_TRUE(front_end.mapping.confirm(candidate, {seen_from, 1})) << "frame " << i;
      ASSERT_EQ(front_end.loops(), loops + 1);
      front_end.settle();
    }
  }

  void wait_for(std::int64_t global_adjustments) {
    for (int i = 0; i < 100 && front_end.counts().global_adjustments < global_adjustments; ++i)
      front_end.track(circuit().back());
    ASSERT_EQ(front_end.counts().global_adjustments, global_adjustments);
  }

  PlayedFrontEnd front_end{AdjustOptions{}, 1};
};

TEST_F(LoopsInARow, DoNotKeepTheMapFromBeingAdjusted) {
  const std::int64_t before = front_end.counts().global_adjustments;
  const double error_before_m = front_end.worst_error_m();
  close_loops(80);
  EXPECT_GE(front_end.counts().global_adjustments, before + 2);
  EXPECT_EQ(front_end.counts().failed_adjustments, 0);
  // The one that runs, and one more with the loops that it did not know.
  const std::int64_t at_the_end = front_end.counts().global_adjustments;
  for (int i = 0; i < 100; ++i) front_end.track(circuit().back());
  EXPECT_EQ(front_end.counts().global_adjustments, at_the_end + 2);
  EXPECT_LT(front_end.worst_error_m(), error_before_m + 0.01);
  const std::uint64_t corrections = front_end.mapping.layout().correction_count;
  for (int i = 0; i < 50; ++i) front_end.track(circuit().back());
  EXPECT_EQ(front_end.mapping.layout().correction_count, corrections) << "there is an end to it";
}

TEST_F(LoopsInARow, AreBentAlongWithWhatTheRunningAdjustmentSays) {
  const std::int64_t before = front_end.counts().global_adjustments;
  close_loops(5);  // two loops: one that is adjusted, one more meanwhile
  const std::vector<Rigid3> bent = front_end.mapping.layout().world_from_submap;
  wait_for(before + 1);
  const std::vector<Rigid3> adjusted = front_end.mapping.layout().world_from_submap;
  wait_for(before + 2);
  const std::vector<Rigid3>& again = front_end.mapping.layout().world_from_submap;
  double bent_off_m = 0, adjusted_off_m = 0;  // from what knows both loops
  for (std::size_t i = 0; i < bent.size(); ++i) {
    bent_off_m += (bent[i].translation - again[i].translation).norm();
    adjusted_off_m += (adjusted[i].translation - again[i].translation).norm();
  }
  EXPECT_LT(adjusted_off_m, 0.5 * bent_off_m);
}

TEST_F(LoopsInARow, ArePartOfTheState) {
  close_loops(10);
  ByteWriter saved;
  front_end.mapping.save(saved);
  const std::string state = saved.take();
  SubmapMapping restored(kCamera, {}, CorrectionTime::kByFrames);
  ByteReader bytes(state);
  restored.restore(bytes);
  ASSERT_TRUE(bytes.ok() && bytes.at_end());
  const std::int64_t before = front_end.counts().global_adjustments;
  for (SubmapMapping* mapping : {&front_end.mapping, &restored}) {
    const std::uint32_t submap = mapping->layout().current;
    const Rigid3 submap_from_camera =
        inverse(mapping->layout().world_from_submap[submap]) * front_end.world_from_camera();
    for (int i = 0; i < 100; ++i)
      mapping->observe(circuit().back().frame,
                       mapping->layout().world_from_submap[submap] * submap_from_camera);
  }
  EXPECT_EQ(front_end.counts().global_adjustments, before + 2);
  EXPECT_EQ(restored.counts(), front_end.mapping.counts());
  const std::vector<Rigid3>& poses = front_end.mapping.layout().world_from_submap;
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_EQ(restored.layout().world_from_submap[i].matrix(), poses[i].matrix());
}

TEST(SubmapMapping, TheSameFramesGiveTheSameMap) {
  std::vector<Rigid3> first;
  AdjustOptions options;
  options.local_bundle_adjustment = true;
  for (int run = 0; run < 2; ++run) {
    PlayedFrontEnd front_end(options, 1);
    for (const Step& step : circuit()) front_end.track(step);
    front_end.mapping.finish();
    const std::vector<Rigid3>& poses = front_end.mapping.layout().world_from_submap;
    if (run == 0) first = poses;
    ASSERT_EQ(poses.size(), first.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(poses[i].translation, first[i].translation);
      EXPECT_EQ(poses[i].rotation.coeffs(), first[i].rotation.coeffs());
    }
  }
}

TEST(SubmapMapping, ATwinOfTheRoomIsNotTakenForIt) {
  // The path leads from the first room through the corridor into its copy. Whoever believed what
  // looks alike would fold one onto the other.
  PlayedFrontEnd front_end({}, 0.3, true);
  for (const Step& step : walk(synthetic::RoomScene::kTwins, 0, 60, 17)) front_end.track(step);
  front_end.mapping.finish();
  EXPECT_LT(front_end.worst_error_m(), 0.2);
}

TEST(SubmapMapping, ALostCameraIsFoundAgain) {
  PlayedFrontEnd front_end({}, 0);
  for (const Step& step : circuit()) front_end.track(step);
  // Taken to where it has been at frame 20, without being told.
  const std::vector<Step> elsewhere = walk(synthetic::RoomScene::kLoop, 20 * 19 + 5, 1, 1);
  const std::vector<LoopCandidate> candidates = front_end.mapping.relocalise(elsewhere[0].frame);
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_TRUE(candidates[0].by_appearance);
  const std::optional<Rigid3> seen_from = front_end.verify(candidates[0], elsewhere[0]);
  ASSERT_TRUE(seen_from);
  front_end.mapping.relocalised(candidates[0], *seen_from);
  const MapLayout& layout = front_end.mapping.layout();
  EXPECT_TRUE(layout.is_active[layout.current]);
  EXPECT_LT((layout.world_from_submap[layout.current].translation - seen_from->translation).norm(),
            0.6);
}

TEST(SubmapMapping, ANewPartIsJoinedWhenItSeesTheOldOne) {
  PlayedFrontEnd front_end({}, 0);
  const std::vector<Step>& steps = circuit();
  for (std::size_t i = 0; i < 20; ++i) front_end.track(steps[i]);
  // Lost between 20 and 30, and taken for where it was last.
  front_end.mapping.begin_component(front_end.world_from_camera(), 10);
  front_end.is_at(front_end.world_from_camera(), steps[30]);
  const std::uint32_t component = front_end.mapping.layout().component.back();
  EXPECT_NE(component, front_end.mapping.layout().component[0]);
  // Backwards to known ground.
  for (std::size_t i = 30; i > 10; --i) front_end.track(steps[i]);
  EXPECT_EQ(front_end.counts().joined_components, 1);
  for (const std::uint32_t of_submap : front_end.mapping.layout().component)
    EXPECT_EQ(of_submap, front_end.mapping.layout().component[0]);
  EXPECT_LT(front_end.worst_error_m(), 0.05);
}

TEST(SubmapMapping, TheFirstPartStaysWhereverTheCameraMeetsTheOther) {
  PlayedFrontEnd front_end({}, 0);
  const std::vector<Step>& steps = circuit();
  for (std::size_t i = 0; i < 20; ++i) front_end.track(steps[i]);
  front_end.mapping.begin_component(front_end.world_from_camera(), 10);
  front_end.is_at(front_end.world_from_camera(), steps[26]);
  for (std::size_t i = 26; i < 32; ++i) front_end.track(steps[i]);
  // Carried back and found, then on to where the second component began.
  const std::vector<LoopCandidate> candidates = front_end.mapping.relocalise(steps[17].frame);
  ASSERT_EQ(candidates.size(), 1u);
  const std::optional<Rigid3> seen_from = front_end.verify(candidates[0], steps[17]);
  ASSERT_TRUE(seen_from);
  front_end.mapping.relocalised(candidates[0], *seen_from);
  front_end.is_at(*seen_from, steps[17]);
  EXPECT_EQ(front_end.mapping.layout().component[front_end.mapping.layout().current], 0u);
  for (std::size_t i = 17; i < 32; ++i) front_end.track(steps[i]);
  EXPECT_EQ(front_end.counts().joined_components, 1);
  EXPECT_EQ(front_end.mapping.layout().world_from_submap[0].translation.norm(), 0);
  EXPECT_LT(front_end.worst_error_m(), 0.05);
}

TEST(SubmapMapping, NoisyNonsenseDoesNoHarm) {
  PlayedFrontEnd front_end({}, 0);
  Step step{
      Rigid3{},
      {0, DepthImage(kCamera.width, kCamera.height), ColorImage(kCamera.width, kCamera.height)}};
  for (int i = 0; i < 30; ++i) {
    step.world_from_camera.translation.x() += 0.2;
    front_end.track(step);
  }
  EXPECT_TRUE(front_end.mapping.relocalise(step.frame).empty());
  front_end.mapping.finish();
  EXPECT_LT(front_end.worst_error_m(), 1e-6);
}

TEST(MakeMapping, WithoutAnyAdjustmentThereIsNone) {
  AdjustOptions options;
  options.global_bundle_adjustment = false;
  EXPECT_EQ(make_mapping(kCamera, options, CorrectionTime::kByFrames), nullptr);
}

}  // namespace
}  // namespace hermite::adjust
