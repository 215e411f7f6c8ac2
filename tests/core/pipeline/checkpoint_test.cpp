// A scan that is broken off and gone on with from its last checkpoint ends exactly like one that
// never was.
#include "core/pipeline/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <random>

#include "core/pipeline/pipeline.h"
#include "tests/support/doomed_surfels.h"
#include "tests/support/recording.h"
#include "tests/support/surfels_behind.h"

namespace hermite::pipeline::checkpoint_test {
namespace {

using testing::HasSubstr;

// Three metres of a circuit, 7 cm from one frame to the next.
const test::Recording& walk() {
  static const test::Recording made = test::record(
      "synthetic:scene=loop,frames=48,width=160,height=120,rate=6,noise=kinect-white,seed=1"
      "+accelerometer");
  return made;
}

constexpr std::size_t kEmptyFrame = 1000;

frame::RgbdFrame empty_frame(double timestamp_s) {
  const Camera& camera = walk().camera;
  return {timestamp_s, DepthImage(camera.width, camera.height),
          ColorImage(camera.width, camera.height)};
}

Options adjusted_often() {
  Options options;
  options.map.stable_confidence = 1;
  options.adjust.local_bundle_adjustment = true;
  options.adjust.active_path_m = 0.6;
  options.adjust.new_part_after_frames = 4;
  return options;
}

std::unique_ptr<Pipeline> make_pipeline(
    const Options& options, adjust::CorrectionTime time = adjust::CorrectionTime::kByFrames,
    const Camera& camera = walk().camera) {
  return std::make_unique<Pipeline>("", camera, options,
                                    adjust::make_mapping(camera, options.adjust, time));
}

void append(std::string& text, const Rigid3& pose) {
  text.append(reinterpret_cast<const char*>(pose.rotation.coeffs().data()), 4 * sizeof(double));
  text.append(reinterpret_cast<const char*>(pose.translation.data()), 3 * sizeof(double));
}

void append(std::string& text, const output::CloudPoint& point) {
  const float values[] = {point.position_m.x(),      point.position_m.y(),
                          point.position_m.z(),      point.normal.x(),
                          point.normal.y(),          point.normal.z(),
                          point.confidence,          point.curvature_max_per_m,
                          point.curvature_min_per_m, point.radius_m};
  text.append(reinterpret_cast<const char*>(values), sizeof values);
  text.append(reinterpret_cast<const char*>(&point.color), sizeof point.color);
  text += std::to_string(point.submap);
}

// All that a pipeline tells of a frame, exactly.
std::string told(const FrameResult& result) {
  std::string text = std::to_string(result.frame_index) + name_of(result.status) + result.reason +
                     name_of(result.event) + " " + std::to_string(result.inlier_count) + " " +
                     std::to_string(result.surfel_count) + " " + std::to_string(result.submap) +
                     " " + std::to_string(result.last_tracked_frame);
  const double values[] = {result.timestamp_s, result.inlier_ratio, result.residual_rms_m,
                           result.correction_m, result.last_tracked_timestamp_s};
  text.append(reinterpret_cast<const char*>(values), sizeof values);
  append(text, result.world_from_camera);
  append(text, result.submap_from_camera);
  return text;
}

std::string told(const std::vector<output::SlotChange>& changes) {
  std::string text;
  for (const output::SlotChange& change : changes) {
    text += std::to_string(change.slot) + (change.alive ? "+" : "-");
    append(text, change.point);
  }
  return text;
}

// Poses, tracking with reasons, cloud and changes as they are at the end.
std::string told_at_the_end(Pipeline& pipeline) {
  pipeline.finish();
  std::string text;
  for (const dataset::TimedPose& pose : pipeline.trajectory()) append(text, pose.world_from_camera);
  for (const AnchoredPose& pose : pipeline.anchored_poses())
    text += name_of(pose.status) + pipeline.reasons().text_of(pose.reason);
  for (const SubmapPose& pose : pipeline.submap_poses()) append(text, pose.world_from_submap);
  const Result<output::Cloud> cloud = pipeline.cloud();
  EXPECT_TRUE(cloud.ok());
  for (const output::CloudPoint& point : *cloud) append(text, point);
  const std::optional<UpDirection> up = pipeline.statistics().up;
  EXPECT_TRUE(up.has_value());
  if (up) append(text, Rigid3{Eigen::Quaterniond::Identity(), up->in_world * up->sigma_rad});
  return text + told(*pipeline.take_changes());
}

// When the frames are taken. To carry the camera elsewhere takes two seconds.
std::vector<double> times_s(const std::vector<std::size_t>& frames) {
  std::vector<double> times;
  double time_s = 0;
  std::size_t last = frames.front();
  for (const std::size_t frame : frames) {
    if (frame != kEmptyFrame && std::max(frame, last) - std::min(frame, last) > 10) time_s += 2;
    if (frame != kEmptyFrame) last = frame;
    times.push_back(time_s);
    time_s += 0.1;
  }
  return times;
}

// One scan, frame by frame; viewers are told after every third.
class Scan {
 public:
  Scan(std::vector<std::size_t> frames, std::unique_ptr<Pipeline> made)
      : pipeline(std::move(made)), frames_(std::move(frames)), times_s_(times_s(frames_)) {}

  std::string step(std::size_t i) {
    frame::RgbdFrame frame =
        frames_[i] == kEmptyFrame ? empty_frame(times_s_[i]) : walk().frames[frames_[i]];
    frame.timestamp_s = times_s_[i];
    const Result<FrameResult> result = pipeline->process(frame);
    EXPECT_TRUE(result.ok()) << result.error().message;
    status = result->status;
    return told(*result) + (i % 3 == 2 ? told(*pipeline->take_changes()) : "");
  }
  adjust::MappingCounts counts() const {
    return pipeline->statistics().mapping.value_or(adjust::MappingCounts{});
  }

  std::unique_ptr<Pipeline> pipeline;
  track::TrackingStatus status = track::TrackingStatus::kLost;

 private:
  const std::vector<std::size_t> frames_;
  const std::vector<double> times_s_;
};

std::vector<std::size_t> range(std::size_t from, std::size_t to) {
  std::vector<std::size_t> numbers(to - from);
  std::iota(numbers.begin(), numbers.end(), from);
  return numbers;
}

// Along the walk, blind for a while, then carried back to where it was: submaps, keyframes, a lost
// camera, one that is found again.
std::vector<std::size_t> adventure() {
  std::vector<std::size_t> frames = range(0, 22);
  frames.insert(frames.end(), 2, kEmptyFrame);
  for (const std::size_t i : range(22, 34)) frames.push_back(i);
  for (const std::size_t i : range(8, 16)) frames.push_back(i);
  return frames;
}

struct Undisturbed {
  std::vector<std::string> told;              // by frame
  std::map<std::size_t, std::string> states;  // by the number of frames before
  std::string end;
};

// Whether a scan that goes on from `states[k]` tells the same and comes to the same state.
void expect_same_from(const std::vector<std::size_t>& frames, std::unique_ptr<Pipeline> fresh,
                      const Undisturbed& undisturbed, std::size_t k) {
  SCOPED_TRACE("gone on with after " + std::to_string(k) + " frames");
  Scan scan(frames, std::move(fresh));
  const Status restored = scan.pipeline->restore(undisturbed.states.at(k));
  ASSERT_TRUE(restored.ok()) << restored.error().message;
  EXPECT_TRUE(*scan.pipeline->save() == undisturbed.states.at(k))
      << "what was read is what was written";
  for (std::size_t i = k; i < frames.size(); ++i) {
    ASSERT_TRUE(scan.step(i) == undisturbed.told[i]) << "frame " << i;
    const auto state = undisturbed.states.find(i + 1);
    if (state == undisturbed.states.end()) continue;
    ASSERT_TRUE(*scan.pipeline->save() == state->second) << "after frame " << i;
  }
  EXPECT_TRUE(told_at_the_end(*scan.pipeline) == undisturbed.end);
}

TEST(Checkpoint, AScanGoesOnAsIfNothingHadBeenBetween) {
  const std::vector<std::size_t> frames = adventure();
  Scan scan(frames, make_pipeline(adjusted_often()));
  Undisturbed undisturbed;
  std::map<std::string, std::size_t> moments;
  std::int64_t submaps = 1;
  const auto save_at = [&](std::size_t k, const std::string& moment) {
    if (!moments.emplace(moment, k).second) return;
    undisturbed.states[k] = *scan.pipeline->save();
  };
  save_at(0, "before the first frame");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    undisturbed.told.push_back(scan.step(i));
    // With the opening of a submap an adjustment begins that is due five frames later.
    if (const std::int64_t now = scan.counts().submaps; now > std::exchange(submaps, now) && i > 8)
      save_at(i + 1, "an adjustment runs");
    if (scan.status == track::TrackingStatus::kLost) save_at(i + 1, "lost");
    if (scan.counts().relocalisations > 0) save_at(i + 1, "found again");
    if (i == 28) save_at(i + 1, "in the midst of it");
  }
  save_at(frames.size(), "at the end");
  undisturbed.end = told_at_the_end(*scan.pipeline);
  EXPECT_THAT(undisturbed.end, HasSubstr("losttoo few points")) << "the scan has no reason to keep";
  EXPECT_GE(scan.counts().submaps, 3);
  EXPECT_GE(scan.counts().local_adjustments, 1);
  ASSERT_EQ(moments.size(), 6u) << "the scan is not the one that this test is about";
  for (const auto& [moment, k] : moments) {
    SCOPED_TRACE(moment);
    expect_same_from(frames, make_pipeline(adjusted_often()), undisturbed, k);
  }
}

// Device memory that has room for little: the other submaps wait in the host's.
Options with_little_memory() {
  Options options = adjusted_often();
  options.adjust.active_path_m = 0.5;
  options.map.gpu_memory_mb = 1;
  try {
    make_pipeline(options);
  } catch (const SetupError& error) {
    const std::string message = error.what(), before = "needs at least ";
    options.map.gpu_memory_mb = std::stoi(message.substr(message.find(before) + before.size()));
  }
  return options;
}

TEST(Checkpoint, SubmapsOnTheHostComeBack) {
  const Options options = with_little_memory();
  const std::vector<std::size_t> frames = range(0, 48);
  Scan scan(frames, make_pipeline(options));
  Undisturbed undisturbed;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    undisturbed.told.push_back(scan.step(i));
    const bool first =
        undisturbed.states.empty() && scan.pipeline->statistics().host_memory_bytes > 0;
    if (first) undisturbed.states[i + 1] = *scan.pipeline->save();
  }
  undisturbed.end = told_at_the_end(*scan.pipeline);
  ASSERT_EQ(undisturbed.states.size(), 1u) << "nothing had to leave";
  expect_same_from(frames, make_pipeline(options), undisturbed, undisturbed.states.begin()->first);
}

TEST(Checkpoint, AFullMapIsFullAsLongAfterwards) {
  const Options options = with_little_memory();
  const std::vector<std::size_t> frames = range(0, 32);
  Scan scan(frames, make_pipeline(options));
  const std::size_t fits = 4 * std::size_t(walk().camera.width * walk().camera.height) - 512;
  ASSERT_TRUE(scan.pipeline->insert(test::surfels_behind(fits)).ok());
  Undisturbed undisturbed;
  std::vector<std::size_t> full;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    undisturbed.told.push_back(scan.step(i));
    if (undisturbed.told.back().find("the map is full") == std::string::npos) continue;
    full.push_back(i);
    undisturbed.states[i + 1] = *scan.pipeline->save();
  }
  undisturbed.end = told_at_the_end(*scan.pipeline);
  ASSERT_TRUE(full.size() > 3 && full.size() + 3 < frames.size())
      << "the scan is not the one that this test is about: " << full.size();
  for (const std::size_t i : {full[0], full[full.size() / 2], full.back()})
    expect_same_from(frames, make_pipeline(options), undisturbed, i + 1);
}

TEST(Checkpoint, PartsThatAreNotJoinedYetComeBack) {
  // Carried to where it has never been, and walked back to where both parts meet.
  std::vector<std::size_t> frames = range(0, 12);
  for (std::size_t i = 40; i > 6; --i) frames.push_back(i);
  Scan scan(frames, make_pipeline(adjusted_often()));
  Undisturbed undisturbed;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    undisturbed.told.push_back(scan.step(i));
    if (i + 1 != 26) continue;
    EXPECT_EQ(scan.counts().components, 2);
    undisturbed.states[i + 1] = *scan.pipeline->save();
  }
  EXPECT_EQ(scan.counts().joined_components, 1);
  undisturbed.end = told_at_the_end(*scan.pipeline);
  expect_same_from(frames, make_pipeline(adjusted_often()), undisturbed, 26);
}

// Surfels get other slots, and what has not been told of them yet is told by who goes on.
TEST(Checkpoint, AFrameThatEndsInTheOneBeforeIsRecognisedAfterwards) {
  const std::vector<frame::RgbdFrame>& frames = walk().frames;
  frame::RgbdFrame torn = frames[2];
  std::copy(frames[1].depth.pixels.begin() + 4000, frames[1].depth.pixels.end(),
            torn.depth.pixels.begin() + 4000);
  const std::unique_ptr<Pipeline> first = make_pipeline(adjusted_often());
  const std::unique_ptr<Pipeline> second = make_pipeline(adjusted_often());
  for (std::size_t i = 0; i < 2; ++i) ASSERT_TRUE(first->process(frames[i]).ok());
  ASSERT_TRUE(second->restore(*first->save()).ok());
  const Result<FrameResult> undisturbed = first->process(torn), result = second->process(torn);
  EXPECT_THAT(undisturbed->reason, HasSubstr("its transfer was incomplete"));
  EXPECT_EQ(told(*result), told(*undisturbed));
  EXPECT_EQ(second->statistics().torn_frame_count, 1);
}

TEST(Checkpoint, AMapIsCompactedBeforeAndAfter) {
  Options options = adjusted_often();
  options.map.clean_interval_frames = 1;
  const std::vector<std::size_t> frames = range(0, 14);
  Scan scan(frames, make_pipeline(options));
  ASSERT_TRUE(scan.pipeline->insert(test::doomed_surfels(200'000)).ok());
  ASSERT_TRUE(scan.pipeline->take_changes().ok());
  Undisturbed undisturbed;
  std::optional<std::size_t> compacted_in;  // the frame
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::int64_t slots = scan.pipeline->statistics().surfel_slot_count;
    undisturbed.states[i] = *scan.pipeline->save();
    undisturbed.told.push_back(scan.step(i));
    if (scan.pipeline->statistics().surfel_slot_count < slots / 2) compacted_in = i;
  }
  undisturbed.end = told_at_the_end(*scan.pipeline);
  ASSERT_TRUE(compacted_in && *compacted_in + 3 < frames.size())
      << "the scan is not the one that this test is about";
  // Before it, right after it, and when viewers have been told of some of it or all: they are after
  // every third frame.
  const auto is_far = [&](std::size_t k) { return k < *compacted_in || k > *compacted_in + 3; };
  std::erase_if(undisturbed.states, [&](const auto& state) { return is_far(state.first); });
  for (const auto& [k, state] : undisturbed.states)
    expect_same_from(frames, make_pipeline(options), undisturbed, k);
}

TEST(Checkpoint, AMirrorMayBeginAnew) {
  Scan scan(adventure(), make_pipeline(adjusted_often()));
  for (std::size_t i = 0; i < 6; ++i) scan.step(i);
  EXPECT_TRUE(scan.pipeline->take_changes()->empty());
  scan.pipeline->forget_taken_changes();
  const std::vector<output::SlotChange> all = *scan.pipeline->take_changes();
  EXPECT_EQ(all.size(), scan.pipeline->surfels()->size());
  EXPECT_TRUE(std::all_of(all.begin(), all.end(),
                          [](const output::SlotChange& change) { return change.alive; }));
}

// --- Where it is not gone on from ---

const std::string& some_state() {
  static const std::string state = [] {
    Scan scan(adventure(), make_pipeline(adjusted_often()));
    for (std::size_t i = 0; i < 14; ++i) scan.step(i);
    EXPECT_GE(scan.counts().keyframes, 2);
    return *scan.pipeline->save();
  }();
  return state;
}

Error refusal(std::unique_ptr<Pipeline> pipeline, std::string_view state) {
  const Status restored = pipeline->restore(state);
  EXPECT_FALSE(restored.ok());
  return restored.ok() ? Error{} : restored.error();
}

TEST(Checkpoint, OtherConditionsAreRefusedByName) {
  Options weight = adjusted_often();
  weight.track.geometric_weight *= 2;
  Camera camera = walk().camera;
  camera.fx += 1;
  Camera corrected = walk().camera;
  corrected.depth_correction.bend = 0.01;
  Camera rolling = walk().camera;
  rolling.timing.depth_readout_s = 0.03;
  const Options options = adjusted_often();
  const std::pair<Error, const char*> cases[] = {
      {refusal(make_pipeline(weight), some_state()), "track.geometric_weight"},
      {refusal(make_pipeline(options, adjust::CorrectionTime::kByFrames, camera), some_state()),
       "camera"},
      {refusal(make_pipeline(options, adjust::CorrectionTime::kByFrames, corrected), some_state()),
       "camera"},
      {refusal(make_pipeline(options, adjust::CorrectionTime::kByFrames, rolling), some_state()),
       "camera"},
      {refusal(std::make_unique<Pipeline>("", walk().camera, options), some_state()), "mapping"},
  };
  for (const auto& [error, name] : cases) {
    EXPECT_EQ(error.code, ErrorCode::kUnsupported);
    EXPECT_THAT(error.message, HasSubstr(name));
    EXPECT_THAT(error.message, HasSubstr("checkpoint"));
  }
  EXPECT_THAT(
      refusal(make_pipeline(options, adjust::CorrectionTime::kWhenReady), some_state()).message,
      HasSubstr("another mode"));
  EXPECT_FALSE(program_identity().empty());
  std::string other_program = some_state();
  other_program[other_program.find(program_identity())] = 'x';
  EXPECT_THAT(refusal(make_pipeline(options), other_program).message, HasSubstr("program"));
  std::string other_format = some_state();
  other_format[7] = '2';
  EXPECT_EQ(refusal(make_pipeline(options), other_format).code, ErrorCode::kUnsupported);
}

TEST(Checkpoint, ACutOneIsCorrupt) {
  const std::string& state = some_state();
  std::mt19937 random(3);
  std::vector<std::size_t> lengths{0, 1, 7, 8, 16, state.size() - 1};
  for (int i = 0; i < 14; ++i) lengths.push_back(random() % state.size());
  for (const std::size_t length : lengths)
    EXPECT_EQ(
        refusal(make_pipeline(adjusted_often()), std::string_view(state).substr(0, length)).code,
        ErrorCode::kCorruptData)
        << length;
  EXPECT_THAT(refusal(make_pipeline(adjusted_often()), state + "x").message,
              HasSubstr("after the checkpoint"));
}

// There is no checksum here: what passes for a state is one, and the scan lives on with it.
TEST(Checkpoint, ADamagedOneIsRefusedOrLivedWith) {
  const std::string& state = some_state();
  std::mt19937 random(5);
  constexpr unsigned kRounds = 12;
  unsigned refused = 0;
  for (unsigned round = 0; round < kRounds; ++round) {
    SCOPED_TRACE(round);
    std::string damaged = state;
    // Whole, its front, where counts and indices lie closer together than among surfels, or its
    // settings, of which none is lived with.
    const std::size_t reach = std::min<std::size_t>(
        damaged.size(), std::array<std::size_t, 3>{damaged.size(), 300'000, 300}[round % 3]);
    for (int blow = 0; blow < 3; ++blow) damaged[random() % reach] = static_cast<char>(random());
    Scan scan(adventure(), make_pipeline(adjusted_often()));
    if (const Status restored = scan.pipeline->restore(damaged); !restored.ok()) {
      EXPECT_FALSE(restored.error().message.empty());
      ++refused;
      continue;
    }
    scan.step(14);
    EXPECT_TRUE(scan.pipeline->take_changes().ok());
  }
  EXPECT_GT(refused, 0u);
  EXPECT_LT(refused, kRounds);
}

}  // namespace
}  // namespace hermite::pipeline::checkpoint_test
