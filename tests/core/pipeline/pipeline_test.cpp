#include "core/pipeline/pipeline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "core/evaluate/trajectory_error.h"
#include "tests/support/doomed_surfels.h"
#include "tests/support/recording.h"

namespace hermite::pipeline::pipeline_test {
namespace {

using testing::HasSubstr;

// A hand's motion through a furnished room, at a size that a software device does in milliseconds.
constexpr int kFrameCount = 12;

const test::Recording& recording() {
  static const test::Recording made =
      test::record("synthetic:frames=" + std::to_string(kFrameCount) + ",width=160,height=120");
  return made;
}

// So that a few frames suffice to make surfels that are put out.
Options soon_stable() {
  Options options;
  options.map.stable_confidence = 1;
  return options;
}

FrameResult process(Pipeline& pipeline, const frame::RgbdFrame& frame) {
  const Result<FrameResult> result = pipeline.process(frame);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return *result;
}

bool same_pose(const Rigid3& a, const Rigid3& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

bool same_point(const output::CloudPoint& a, const output::CloudPoint& b) {
  return a.position_m == b.position_m && a.normal == b.normal && a.color == b.color &&
         a.confidence == b.confidence && a.curvature_max_per_m == b.curvature_max_per_m &&
         a.curvature_min_per_m == b.curvature_min_per_m && a.radius_m == b.radius_m &&
         a.submap == b.submap;
}

TEST(Pipeline, FollowsASyntheticCamera) {
  const test::Recording& room = recording();
  Pipeline pipeline("", room.camera, Options{});
  for (int i = 0; i < kFrameCount; ++i) {
    const FrameResult result = process(pipeline, room.frames[static_cast<std::size_t>(i)]);
    EXPECT_EQ(result.frame_index, i);
    EXPECT_EQ(result.timestamp_s, room.frames[static_cast<std::size_t>(i)].timestamp_s);
    EXPECT_EQ(result.status, track::TrackingStatus::kTracked) << i << ": " << result.reason;
    EXPECT_EQ(result.reason, "");
    EXPECT_GT(result.surfel_count, 1000);
    if (i == 0) continue;
    EXPECT_GT(result.inlier_count, 1000);
    EXPECT_GT(result.inlier_ratio, 0.5);
    EXPECT_LE(result.inlier_ratio, 1);
    EXPECT_LT(result.residual_rms_m, 0.01);
  }
  const auto error = evaluate::trajectory_error(pipeline.trajectory(), room.groundtruth);
  ASSERT_TRUE(error.ok()) << error.error().message;
  // The hand moves by 18 cm and 15 degrees. One pixel is 2 cm wide where the room is 2.5 m away.
  EXPECT_LT(error->ate_m.rmse, 0.005);
  EXPECT_LT(error->per_frame.rotation_deg.rmse, 0.2);
}

TEST(Pipeline, TheWorldIsTheFirstCamera) {
  Pipeline pipeline("", recording().camera, Options{});
  EXPECT_TRUE(same_pose(process(pipeline, recording().frames[0]).world_from_camera, Rigid3{}));
  const std::vector<SubmapPose> poses = pipeline.submap_poses();
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_TRUE(same_pose(poses[0].world_from_submap, Rigid3{}));
}

TEST(Pipeline, TwoRunsAreTheSameBitForBit) {
  std::vector<dataset::Trajectory> trajectories;
  std::vector<output::Cloud> clouds;
  for (int run = 0; run < 2; ++run) {
    Pipeline pipeline("", recording().camera, soon_stable());
    for (const frame::RgbdFrame& frame : recording().frames) process(pipeline, frame);
    trajectories.push_back(pipeline.trajectory());
    clouds.push_back(*pipeline.cloud());
  }
  ASSERT_EQ(trajectories[0].size(), trajectories[1].size());
  for (std::size_t i = 0; i < trajectories[0].size(); ++i)
    EXPECT_TRUE(
        same_pose(trajectories[0][i].world_from_camera, trajectories[1][i].world_from_camera))
        << i;
  ASSERT_EQ(clouds[0].size(), clouds[1].size());
  EXPECT_GT(clouds[0].size(), 1000u);
  for (std::size_t i = 0; i < clouds[0].size(); ++i)
    ASSERT_TRUE(same_point(clouds[0][i], clouds[1][i])) << i;
}

// --- What frames may contain ---

frame::RgbdFrame changed(const frame::RgbdFrame& frame,
                         const std::function<void(std::uint16_t& depth, Rgb8& color)>& change) {
  frame::RgbdFrame result = frame;
  for (std::size_t i = 0; i < result.depth.pixels.size(); ++i)
    change(result.depth.pixels[i], result.color.pixels[i]);
  return result;
}

std::uint8_t random_byte() {
  static std::mt19937 random(1);
  return static_cast<std::uint8_t>(random());
}

struct Garbage {
  const char* name;
  std::function<void(std::uint16_t&, Rgb8&)> change;
};

std::vector<Garbage> garbage() {
  return {{"no depth", [](std::uint16_t& d, Rgb8&) { d = 0; }},
          {"nothing at all",
           [](std::uint16_t& d, Rgb8& c) {
             d = 0;
             c = {};
           }},
          {"depth out of range, white",
           [](std::uint16_t& d, Rgb8& c) {
             d = 65535, c = {255, 255, 255};
           }},
          {"noise",
           [](std::uint16_t& d, Rgb8& c) {
             d = static_cast<std::uint16_t>(256 * random_byte() + random_byte());
             c = {random_byte(), random_byte(), random_byte()};
           }},
          {"a wall right in front of it", [](std::uint16_t& d, Rgb8&) { d = 2000; }}};
}

TEST(Pipeline, AFrameThatCannotBeUsedIsLostAndTheNextOneIsNot) {
  const test::Recording& room = recording();
  Pipeline pipeline("", room.camera, Options{});
  FrameResult good;
  std::size_t next = 0;
  while (next < 4) good = process(pipeline, room.frames[next++]);
  std::int64_t given_count = 4, lost_count = 0;
  for (const Garbage& bad : garbage()) {
    SCOPED_TRACE(bad.name);
    const FrameResult lost = process(pipeline, changed(room.frames[next], bad.change));
    ++lost_count;
    EXPECT_EQ(lost.status, track::TrackingStatus::kLost);
    EXPECT_FALSE(lost.reason.empty());
    EXPECT_TRUE(same_pose(lost.world_from_camera, good.world_from_camera)) << "the last good pose";
    EXPECT_EQ(lost.surfel_count, good.surfel_count) << "nothing is fused";
    EXPECT_EQ(lost.frame_index, given_count++);
    EXPECT_EQ(pipeline.trajectory().back().timestamp_s, room.frames[next].timestamp_s)
        << "a pose for every frame, lost ones included";
    const FrameResult after = process(pipeline, room.frames[next]);
    EXPECT_EQ(after.status, track::TrackingStatus::kTracked) << after.reason;
    EXPECT_EQ(after.frame_index, given_count++);
    EXPECT_EQ(pipeline.anchored_poses().end()[-2].status, track::TrackingStatus::kLost);
    EXPECT_EQ(pipeline.anchored_poses().back().status, track::TrackingStatus::kTracked);
    const Rigid3 true_motion = inverse(room.groundtruth[next - 1].world_from_camera) *
                               room.groundtruth[next].world_from_camera;
    const Rigid3 motion = inverse(good.world_from_camera) * after.world_from_camera;
    EXPECT_LT((motion.translation - true_motion.translation).norm(), 0.01);
    good = after;
    ++next;
  }
  EXPECT_EQ(pipeline.statistics().frame_count, given_count);
  EXPECT_EQ(pipeline.statistics().tracked_frame_count, given_count - lost_count);
}

TEST(Pipeline, WithoutColourDepthIsEnough) {
  Pipeline pipeline("", recording().camera, Options{});
  for (const Rgb8 color : {Rgb8{255, 255, 255}, Rgb8{0, 0, 0}})
    for (std::size_t i = 0; i < 3; ++i) {
      const frame::RgbdFrame frame =
          changed(recording().frames[i], [color](std::uint16_t&, Rgb8& c) { c = color; });
      EXPECT_EQ(process(pipeline, frame).status, track::TrackingStatus::kTracked) << i;
    }
}

TEST(Pipeline, StartsWithTheFirstFrameThatShowsSomething) {
  const test::Recording& room = recording();
  Pipeline pipeline("", room.camera, Options{});
  const frame::RgbdFrame empty = changed(room.frames[0], [](std::uint16_t& d, Rgb8&) { d = 0; });
  for (int i = 0; i < 2; ++i) {
    const FrameResult result = process(pipeline, empty);
    EXPECT_EQ(result.status, track::TrackingStatus::kLost);
    EXPECT_THAT(result.reason, HasSubstr("almost nothing"));
    EXPECT_EQ(result.surfel_count, 0);
  }
  EXPECT_TRUE(pipeline.cloud()->empty());
  EXPECT_TRUE(pipeline.take_changes()->empty());
  EXPECT_EQ(process(pipeline, room.frames[3]).status, track::TrackingStatus::kTracked);
  EXPECT_TRUE(same_pose(pipeline.trajectory()[2].world_from_camera, Rigid3{}));
  EXPECT_EQ(process(pipeline, room.frames[4]).status, track::TrackingStatus::kTracked);
}

TEST(Pipeline, AnImageThatComesOnceMoreIsWeakAndTheCameraGoesOnAlone) {
  const auto& frames = recording().frames;
  Pipeline once("", recording().camera, Options{}), twice("", recording().camera, Options{});
  for (std::size_t i = 0; i < 6; ++i) {
    const FrameResult first = process(once, frames[i]), again = process(twice, frames[i]);
    EXPECT_EQ(again.status, track::TrackingStatus::kTracked) << i;
    EXPECT_TRUE(same_pose(first.world_from_camera, again.world_from_camera)) << i;
    if (i != 3) continue;
    FrameResult last = again;
    const auto length_m = [](const Rigid3& pose) { return pose.translation.norm(); };
    const Rigid3 motion =
        inverse(once.trajectory()[i - 1].world_from_camera) * again.world_from_camera;
    for (int repeat = 1; repeat <= 2; ++repeat) {
      frame::RgbdFrame repeated = frames[i];
      const double since = 0.3 * repeat;  // of the time between two frames
      repeated.timestamp_s += since * (frames[i].timestamp_s - frames[i - 1].timestamp_s);
      const FrameResult still = process(twice, repeated);
      EXPECT_EQ(still.status, track::TrackingStatus::kWeak);
      EXPECT_THAT(still.reason, HasSubstr("repeats the last one"));
      const Rigid3 on = inverse(again.world_from_camera) * still.world_from_camera;
      EXPECT_LT((on.translation - since * motion.translation).norm(),
                0.1 * since * length_m(motion));
      EXPECT_GT(length_m(motion), 0);
      EXPECT_EQ(still.surfel_count, again.surfel_count);
      EXPECT_GT(still.uncertainty->position_sigma_m(), last.uncertainty->position_sigma_m())
          << "the camera may have gone on";
      last = still;
    }
  }
  EXPECT_EQ(twice.trajectory().size(), once.trajectory().size() + 2);
}

TEST(Pipeline, AFrameOfAnotherSizeIsAnErrorAndNothingElse) {
  const test::Recording& room = recording();
  Pipeline pipeline("", room.camera, Options{});
  process(pipeline, room.frames[0]);
  frame::RgbdFrame small_depth = room.frames[1], small_color = room.frames[1];
  small_depth.depth = DepthImage(80, 60);
  small_color.color = ColorImage(120, 160);
  for (const frame::RgbdFrame& frame : {small_depth, small_color, frame::RgbdFrame{}}) {
    const Result<FrameResult> result = pipeline.process(frame);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(result.error().message, HasSubstr("160x120"));
  }
  EXPECT_EQ(pipeline.trajectory().size(), 1u);
  const FrameResult next = process(pipeline, room.frames[1]);
  EXPECT_EQ(next.status, track::TrackingStatus::kTracked) << next.reason;
  EXPECT_EQ(next.frame_index, 1);
}

TEST(Pipeline, ACameraOrDeviceThatCannotBeIsSaidAtOnce) {
  Camera camera = recording().camera;
  camera.fx = -1;
  try {
    Pipeline("", camera, Options{});
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_EQ(error.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(error.what(), HasSubstr("camera.fx"));
  }
  EXPECT_THROW(Pipeline("", Camera{}, Options{}), SetupError);
  EXPECT_THROW(Pipeline("a device that nobody has", recording().camera, Options{}), SetupError);
}

// --- What happened to the map ---

frame::RgbdFrame empty_frame() {
  return changed(recording().frames[0], [](std::uint16_t& d, Rgb8& c) {
    d = 0;
    c = {};
  });
}

// Another place: what is seen there fits nothing, and is enough to begin with.
frame::RgbdFrame upside_down(const frame::RgbdFrame& frame) {
  frame::RgbdFrame turned = frame;
  std::reverse(turned.depth.pixels.begin(), turned.depth.pixels.end());
  std::reverse(turned.color.pixels.begin(), turned.color.pixels.end());
  return turned;
}

// A back end that does what the test says.
class PlayedMapping final : public adjust::Mapping {
 public:
  const adjust::MapLayout& layout() const override { return map; }
  std::vector<adjust::LoopCandidate> observe(const frame::RgbdFrame&,
                                             const Rigid3& world_from_camera) override {
    if (!confirms) return {};
    return {at(world_from_camera)};
  }
  bool confirm(const adjust::LoopCandidate&, const adjust::LoopVerification&) override {
    confirms(map);
    ++map.closure_count;
    confirms = nullptr;
    return true;
  }
  std::vector<adjust::LoopCandidate> relocalise(const frame::RgbdFrame&) override {
    if (!found_at) return {};
    return {at(*found_at)};
  }
  bool is_distinctive(const frame::RgbdFrame&, const Rigid3&, std::int64_t) const override {
    return is_once;
  }
  void relocalised(const adjust::LoopCandidate&, const Rigid3&) override { map.is_active = {true}; }
  void begin_component(const Rigid3& world_from_camera, double) override {
    map.world_from_submap.push_back(world_from_camera);
    map.is_active = {false, true};
    map.component = {0, 1};
    map.current = 1;
  }
  void finish() override {}
  adjust::MappingCounts counts() const override {
    adjust::MappingCounts counts;
    counts.components = static_cast<std::int64_t>(adjust::component_count(map));
    return counts;
  }
  void save(ByteWriter&) const override {}
  void restore(ByteReader&) override {}

  // Of the current submap, which surely shows what the camera sees.
  adjust::LoopCandidate at(const Rigid3& world_from_camera) const {
    adjust::LoopCandidate candidate{world_from_camera, std::vector<bool>(map.component.size())};
    candidate.submaps[map.current] = true;
    return candidate;
  }

  std::function<void(adjust::MapLayout&)> confirms;  // once: what a confirmed candidate does
  std::optional<Rigid3> found_at;
  bool is_once = true;  // what the camera sees
  adjust::MapLayout map;
};

// All submaps by 3 cm.
void move(adjust::MapLayout& layout) {
  for (Rigid3& pose : layout.world_from_submap) pose.translation.y() += 0.03;
  ++layout.correction_count;
}

TEST(Pipeline, EveryFrameSaysWhereItIsInItsSubmap) {
  Pipeline pipeline("", recording().camera, Options{});
  for (std::size_t i = 0; i < 3; ++i) {
    const FrameResult result = process(pipeline, recording().frames[i]);
    EXPECT_EQ(result.submap, 0u);
    EXPECT_TRUE(same_pose(result.submap_from_camera, result.world_from_camera))
        << "the first submap is the world";
    EXPECT_EQ(result.event, MapEvent::kNone);
    EXPECT_EQ(result.correction_m, 0);
    EXPECT_EQ(result.last_tracked_frame, result.frame_index);
    EXPECT_EQ(result.last_tracked_timestamp_s, result.timestamp_s);
  }
}

TEST(Pipeline, ALostCameraHasALastViewAndIsFoundAgain) {
  const test::Recording& room = recording();
  Pipeline pipeline("", room.camera, Options{});
  const FrameResult nothing_yet = process(pipeline, empty_frame());
  EXPECT_EQ(nothing_yet.event, MapEvent::kNone) << "what was never seen is not lost";
  EXPECT_EQ(nothing_yet.last_tracked_frame, -1);
  EXPECT_EQ(process(pipeline, room.frames[0]).event, MapEvent::kNone);
  EXPECT_EQ(process(pipeline, room.frames[1]).event, MapEvent::kNone);
  for (const MapEvent event : {MapEvent::kLost, MapEvent::kNone, MapEvent::kNone}) {
    const FrameResult lost = process(pipeline, empty_frame());
    EXPECT_EQ(lost.event, event);
    EXPECT_EQ(lost.last_tracked_frame, 2);
    EXPECT_EQ(lost.last_tracked_timestamp_s, room.frames[1].timestamp_s);
  }
  EXPECT_EQ(process(pipeline, room.frames[2]).event, MapEvent::kFoundAgain);
  EXPECT_EQ(process(pipeline, room.frames[3]).event, MapEvent::kNone);
}

TEST(Pipeline, AClosedLoopIsToldWithWhatItMoved) {
  auto mapping = std::make_unique<PlayedMapping>();
  PlayedMapping& played = *mapping;
  Pipeline pipeline("", recording().camera, soon_stable(), std::move(mapping));
  FrameResult result;
  std::size_t next = 0;
  while (next < 5) result = process(pipeline, recording().frames[next++]);
  EXPECT_EQ(result.correction_m, 0);
  const dataset::Trajectory before = pipeline.trajectory();
  played.confirms = move;
  result = process(pipeline, recording().frames[next]);
  EXPECT_EQ(result.event, MapEvent::kLoopClosed);
  EXPECT_NEAR(result.correction_m, 0.03, 1e-12);
  EXPECT_NEAR((result.world_from_camera.translation - result.submap_from_camera.translation).y(),
              0.03, 1e-12);
  EXPECT_NEAR((pipeline.trajectory()[2].world_from_camera.translation -
               before[2].world_from_camera.translation)
                  .y(),
              0.03, 1e-12);
  EXPECT_EQ(process(pipeline, recording().frames[next + 1]).event, MapEvent::kNone);
}

TEST(Pipeline, ACameraFoundElsewhereSaysSo) {
  auto mapping = std::make_unique<PlayedMapping>();
  PlayedMapping& played = *mapping;
  Pipeline pipeline("", recording().camera, soon_stable(), std::move(mapping));
  for (std::size_t i = 0; i < 6; ++i) process(pipeline, recording().frames[i]);
  played.map.is_active = {false};  // where the camera was last there is nothing to be found
  played.found_at = pipeline.trajectory()[3].world_from_camera;
  EXPECT_EQ(process(pipeline, empty_frame()).event, MapEvent::kLost)
      << "a guess that nothing speaks for";
  const std::optional<Rigid3> there = std::exchange(played.found_at, std::nullopt);
  EXPECT_EQ(process(pipeline, recording().frames[3]).event, MapEvent::kNone)
      << "nobody says where to look";
  played.found_at = there;
  const FrameResult found = process(pipeline, recording().frames[3]);
  EXPECT_EQ(found.event, MapEvent::kFoundAgain) << found.reason;
  EXPECT_EQ(found.last_tracked_frame, found.frame_index);
  EXPECT_LT((found.world_from_camera.translation - played.found_at->translation).norm(), 0.01);
}

TEST(Pipeline, APartBeginsWhereNothingIsFoundAndIsJoined) {
  auto mapping = std::make_unique<PlayedMapping>();
  PlayedMapping& played = *mapping;
  Options options = soon_stable();
  options.adjust.new_part_after_frames = 2;
  Pipeline pipeline("", recording().camera, options, std::move(mapping));
  for (std::size_t i = 0; i < 3; ++i) process(pipeline, recording().frames[i]);
  EXPECT_EQ(process(pipeline, upside_down(recording().frames[3])).event, MapEvent::kLost);
  const FrameResult begins = process(pipeline, upside_down(recording().frames[3]));
  EXPECT_EQ(begins.event, MapEvent::kNewPart) << begins.reason;
  EXPECT_EQ(begins.submap, 1u);
  EXPECT_EQ(begins.last_tracked_frame, begins.frame_index);
  ASSERT_EQ(pipeline.submap_poses().size(), 2u);
  EXPECT_EQ(pipeline.submap_poses()[0].component, 0u);
  EXPECT_EQ(pipeline.submap_poses()[1].component, 1u);
  EXPECT_EQ(pipeline.statistics().mapping.value().components, 2);
  for (std::size_t i = 4; i < 8; ++i)
    EXPECT_EQ(process(pipeline, upside_down(recording().frames[i])).event, MapEvent::kNone) << i;
  played.confirms = [](adjust::MapLayout& layout) { layout.component = {0, 0}; };
  EXPECT_EQ(process(pipeline, upside_down(recording().frames[8])).event, MapEvent::kJoined);
  EXPECT_EQ(pipeline.statistics().mapping.value().components, 1);
}

// --- What comes out ---

// Beside the scan, what take_changes() says.
class Mirror {
 public:
  void follow(Pipeline& pipeline) {
    std::int64_t last_slot = -1;
    const std::vector<output::SlotChange> changes = *pipeline.take_changes();
    for (const output::SlotChange& change : changes) {
      EXPECT_GT(std::int64_t{change.slot}, last_slot) << "in slot order";
      last_slot = change.slot;
      if (change.alive)
        points[change.slot] = change.point;
      else
        points.erase(change.slot);
    }
  }

  void expect_to_be(const output::Cloud& cloud, std::size_t frame) const {
    ASSERT_EQ(points.size(), cloud.size()) << frame;
    std::size_t next = 0;
    for (const auto& [slot, point] : points)
      ASSERT_TRUE(same_point(point, cloud[next++])) << "frame " << frame << ", slot " << slot;
  }

  std::map<std::uint32_t, output::CloudPoint> points;
};

TEST(Pipeline, ChangesKeepAMirrorOfTheSurfels) {
  Options options = soon_stable();
  options.map.max_unstable_age_frames = 4;  // so that slots are freed and used again
  Pipeline pipeline("", recording().camera, options);
  Mirror mirror;
  for (std::size_t i = 0; i < recording().frames.size(); ++i) {
    process(pipeline, recording().frames[i]);
    if (i % 3 == 1) continue;  // not after every frame
    mirror.follow(pipeline);
    mirror.expect_to_be(*pipeline.surfels(), i);
  }
  EXPECT_GT(mirror.points.size(), 1000u);
  EXPECT_TRUE(pipeline.take_changes()->empty()) << "nothing has happened since";
}

// What is seen once and goes leaves slots behind, and the map is compacted: surfels get other
// slots, and nothing else happens to them.
TEST(Pipeline, SlotsThatDiedDoNotStayForEver) {
  constexpr std::size_t kDoomed = 200'000;
  Options options = soon_stable();
  options.map.clean_interval_frames = 1;
  Pipeline pipeline("", recording().camera, options);
  ASSERT_TRUE(pipeline.insert(test::doomed_surfels(kDoomed)).ok());
  Mirror mirror;
  mirror.follow(pipeline);
  EXPECT_EQ(mirror.points.size(), kDoomed);
  for (std::size_t i = 0; i < recording().frames.size(); ++i) {
    process(pipeline, recording().frames[i]);
    if (i % 3 == 1) continue;
    mirror.follow(pipeline);
    mirror.expect_to_be(*pipeline.surfels(), i);
  }
  EXPECT_GT(mirror.points.size(), 1000u);
  EXPECT_LT(pipeline.statistics().surfel_slot_count, std::int64_t{kDoomed} / 2)
      << "slots that nobody is in";
}

TEST(Pipeline, OnlyStableSurfelsAreOutputUnlessAskedFor) {
  std::vector<std::size_t> counts;
  for (const bool unstable : {false, true}) {
    Options options = soon_stable();
    options.output_unstable = unstable;
    Pipeline pipeline("", recording().camera, options);
    FrameResult last;
    for (std::size_t i = 0; i < 6; ++i) last = process(pipeline, recording().frames[i]);
    const output::Cloud cloud = *pipeline.cloud();
    counts.push_back(cloud.size());
    for (const output::CloudPoint& point : cloud)
      ASSERT_TRUE(unstable ? point.confidence > 0 : point.confidence >= 1);
    EXPECT_TRUE(!unstable || static_cast<std::int64_t>(cloud.size()) == last.surfel_count);
  }
  EXPECT_GT(counts[0], 100u);
  EXPECT_LT(counts[0], counts[1]);
}

TEST(Pipeline, NormalsInTheCloudLookAtTheCamera) {
  Options options;
  options.output_unstable = true;
  Pipeline pipeline("", recording().camera, options);
  process(pipeline, recording().frames[0]);
  const output::Cloud cloud = *pipeline.cloud();
  EXPECT_GT(cloud.size(), 1000u);
  for (const output::CloudPoint& point : cloud) {
    ASSERT_LT(point.normal.dot(point.position_m), 0);
    ASSERT_NEAR(point.normal.norm(), 1, 1e-4);
    ASSERT_GT(point.radius_m, 0);
  }
}

TEST(Pipeline, EverySwitchStillTracks) {
  for (const auto& [key, value] :
       std::vector<std::pair<const char*, const char*>>{{"map.hrbf_prediction", "false"},
                                                        {"map.correct_bias", "false"},
                                                        {"map.window", "5"},
                                                        {"map.window", "9"},
                                                        {"map.fuse_surface", "false"},
                                                        {"map.weigh_by_radius", "false"},
                                                        {"map.fill_in_below", "0"},
                                                        {"track.dissimilarity_search", "true"},
                                                        {"track.rotation_prealignment", "false"},
                                                        {"frame.hrbf_confidence", "false"},
                                                        {"frame.project_to_surface", "false"}}) {
    SCOPED_TRACE(std::string(key) + "=" + value);
    Options options;
    options.map.stable_confidence = 0.1;  // predictions from the first frame on
    ASSERT_TRUE(apply_setting(options, key, value).ok());
    Pipeline pipeline("", recording().camera, options);
    for (std::size_t i = 0; i < 3; ++i) {
      const FrameResult result = process(pipeline, recording().frames[i]);
      EXPECT_EQ(result.status, track::TrackingStatus::kTracked) << i << ": " << result.reason;
    }
    const Rigid3 true_motion = inverse(recording().groundtruth[0].world_from_camera) *
                               recording().groundtruth[2].world_from_camera;
    // Of 30 mm, with a sixteenth of the usual pixels: splats are the coarsest.
    EXPECT_LT(
        (pipeline.trajectory()[2].world_from_camera.translation - true_motion.translation).norm(),
        0.02);
  }
}

// Rooms scanned before cost memory and nothing else. As many blocks as leave every other block's
// turn for cleaning where it was.
TEST(Pipeline, WhatIsElsewhereChangesNothing) {
  output::Cloud elsewhere(64 * 256);
  for (std::size_t i = 0; i < elsewhere.size(); ++i) {
    elsewhere[i].position_m = {0.01f * static_cast<float>(i % 128),
                               0.01f * static_cast<float>(i / 128), -30};
    elsewhere[i].normal = Eigen::Vector3f::UnitZ();
    elsewhere[i].confidence = 9;
    elsewhere[i].radius_m = 0.02f;
  }
  Pipeline alone("", recording().camera, soon_stable()),
      beside("", recording().camera, soon_stable());
  ASSERT_TRUE(beside.insert(elsewhere).ok());
  for (const frame::RgbdFrame& frame : recording().frames) {
    const FrameResult expected = process(alone, frame), actual = process(beside, frame);
    EXPECT_TRUE(same_pose(actual.world_from_camera, expected.world_from_camera))
        << expected.frame_index;
    EXPECT_EQ(actual.surfel_count,
              expected.surfel_count + static_cast<std::int64_t>(elsewhere.size()));
  }
  const output::Cloud expected = *alone.cloud(), actual = *beside.cloud();
  ASSERT_EQ(actual.size(), elsewhere.size() + expected.size());
  EXPECT_EQ(actual[0].position_m, elsewhere[0].position_m);
  EXPECT_EQ(actual[0].normal, elsewhere[0].normal);
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_TRUE(same_point(actual[elsewhere.size() + i], expected[i])) << i;
}

// Before each frame so many seconds pass. Returns which of them are in doubt about their place, in
// a world of twins.
std::vector<bool> doubts(const std::vector<double>& intervals_s) {
  auto mapping = std::make_unique<PlayedMapping>();
  mapping->is_once = false;
  Pipeline pipeline("", recording().camera, Options{}, std::move(mapping));
  std::vector<bool> found;
  double timestamp_s = 0;
  for (std::size_t i = 0; i < intervals_s.size(); ++i) {
    frame::RgbdFrame frame = recording().frames[i];
    frame.timestamp_s = timestamp_s += intervals_s[i];
    found.push_back(process(pipeline, frame).reason.starts_with("unconfirmed"));
  }
  return found;
}

TEST(Pipeline, ATimeWithoutFramesPutsThePlaceInDoubt) {
  EXPECT_THAT(doubts({0, 0.03, 0.03, 2, 0.03}),
              testing::ElementsAre(false, false, false, true, true));
  EXPECT_THAT(doubts({0, 1, 1, 1.1, 1}), testing::Each(false)) << "a slow camera";
  EXPECT_THAT(doubts({0, 0.03, 0.03, -600, 0.03}), testing::Each(false))
      << "a clock that was put back";
}

TEST(Pipeline, StatisticsSayWhatItCost) {
  Pipeline pipeline("", recording().camera, Options{});
  EXPECT_EQ(pipeline.statistics().frame_count, 0);
  for (std::size_t i = 0; i < 3; ++i) process(pipeline, recording().frames[i]);
  const PipelineStatistics statistics = pipeline.statistics();
  EXPECT_EQ(statistics.frame_count, 3);
  EXPECT_EQ(statistics.tracked_frame_count, 3);
  EXPECT_GT(statistics.surfel_count, 1000);
  EXPECT_GE(statistics.surfel_slot_count, statistics.surfel_count);
  EXPECT_GE(statistics.surfel_capacity, statistics.surfel_slot_count);
  EXPECT_FALSE(statistics.device.empty());
  double sum_ms = 0;
  for (const char* stage : {"preprocess", "track", "fuse", "predict"}) {
    ASSERT_EQ(statistics.stages_ms.count(stage), 1u) << stage;
    sum_ms += statistics.stages_ms.at(stage);
  }
  EXPECT_GT(sum_ms, 0);
  EXPECT_LE(sum_ms, statistics.mean_frame_ms);
  for (const char* purpose : {"map", "frame", "prediction"})
    EXPECT_GT(statistics.gpu_memory_bytes.at(purpose), 0) << purpose;
  EXPECT_EQ(statistics.gpu_passes_ms.count("map/predict"), 1u);
}

TEST(Pipeline, ATimelineGetsEveryStageAndPass) {
  Timeline timeline;
  Pipeline pipeline("", recording().camera, Options{}, nullptr, &timeline);
  const Timeline::Clock::time_point start = Timeline::Clock::now();
  for (std::size_t i = 0; i < 2; ++i) process(pipeline, recording().frames[i]);
  std::vector<std::string> stages;
  for (const Timeline::Stage& stage : timeline.stages) stages.push_back(stage.name);
  EXPECT_THAT(stages, testing::ElementsAre("preprocess", "track", "fuse", "predict", "preprocess",
                                           "track", "fuse", "predict"));
  EXPECT_GE(timeline.stages.front().start, start);
  std::map<std::string, double> pass_sums_ms;
  for (const Timeline::Pass& pass : timeline.passes) pass_sums_ms[pass.name] += pass.duration_ms;
  for (const auto& [pass, ms] : pipeline.statistics().gpu_passes_ms)
    EXPECT_NEAR(pass_sums_ms[pass] / 2, ms, 1e-9) << pass;
}

}  // namespace
}  // namespace hermite::pipeline::pipeline_test
