// The pipeline with its back end, from end to end: a synthetic circuit through two rooms, seen by a
// hasty camera.
#include <gtest/gtest.h>

#include <cmath>

#include "core/evaluate/trajectory_error.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/recording.h"
#include "tests/support/surfels_behind.h"

namespace hermite::pipeline::mapping_test {
namespace {

// Three metres of the circuit, 7 cm from one frame to the next.
const test::Recording& walk() {
  static const test::Recording made = test::record(
      "synthetic:scene=loop,frames=48,width=192,height=144,rate=6,noise=kinect-white,seed=2");
  return made;
}

Options soon_stable() {
  Options options;
  options.map.stable_confidence = 1;
  return options;
}

Pipeline mapped(const Options& options) {
  return Pipeline(
      "", walk().camera, options,
      adjust::make_mapping(walk().camera, options.adjust, adjust::CorrectionTime::kByFrames));
}

FrameResult process(Pipeline& pipeline, std::size_t frame) {
  const Result<FrameResult> result = pipeline.process(walk().frames[frame]);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return *result;
}

// As the refusal of less says.
int least_memory_mb() {
  Options options;
  options.map.gpu_memory_mb = 1;
  try {
    mapped(options);
  } catch (const SetupError& error) {
    const std::string message = error.what(), before = "needs at least ";
    const std::size_t number = message.find(before);
    if (number != std::string::npos) return std::stoi(message.substr(number + before.size()));
  }
  return 0;
}

double ate_rmse_m(const Pipeline& pipeline) {
  const auto error = evaluate::trajectory_error(pipeline.trajectory(), walk().groundtruth);
  EXPECT_TRUE(error.ok());
  return error->ate_m.rmse;
}

TEST(PipelineMapping, OpensSubmapsAndTracksAcrossThem) {
  Pipeline pipeline = mapped(soon_stable());
  for (std::size_t i = 0; i < walk().frames.size(); ++i)
    EXPECT_NE(process(pipeline, i).status, track::TrackingStatus::kLost) << "frame " << i;
  pipeline.finish();
  const auto statistics = pipeline.statistics();
  ASSERT_TRUE(statistics.mapping.has_value());
  EXPECT_GE(statistics.mapping->submaps, 4);
  EXPECT_GE(statistics.mapping->keyframes, 8);
  EXPECT_EQ(pipeline.submap_poses().size(), static_cast<std::size_t>(statistics.mapping->submaps));
  EXPECT_LT(ate_rmse_m(pipeline), 0.02);
  std::vector<bool> has_points(pipeline.submap_poses().size(), false);
  const Result<output::Cloud> cloud = pipeline.cloud();
  for (const output::CloudPoint& point : *cloud) has_points.at(point.submap) = true;
  EXPECT_LE(std::count(has_points.begin(), has_points.end(), false), 1)
      << "the last one may just have begun";
}

TEST(PipelineMapping, TheSameFramesGiveTheSameMapWhateverTheHelperThreadDoes) {
  std::string first;
  Options options = soon_stable();
  options.adjust.local_bundle_adjustment = true;
  for (int run = 0; run < 2; ++run) {
    Pipeline pipeline = mapped(options);
    for (std::size_t i = 0; i < 30; ++i) process(pipeline, i);
    pipeline.finish();
    std::string all = dataset::format_tum_trajectory(pipeline.trajectory());
    const Result<output::Cloud> cloud = pipeline.cloud();
    for (const output::CloudPoint& point : *cloud)
      all.append(reinterpret_cast<const char*>(&point.position_m), sizeof point.position_m);
    if (run == 0) first = all;
    EXPECT_EQ(all, first);
  }
}

TEST(PipelineMapping, ACameraCarriedAwayIsFoundWhereItHasBeen) {
  Pipeline pipeline = mapped(soon_stable());
  for (std::size_t i = 0; i < 36; ++i) process(pipeline, i);
  // Back to where it was 4 s ago, without a frame between.
  int found_after = -1;
  for (std::size_t i = 10; i < 20; ++i) {
    const FrameResult result = process(pipeline, i);
    if (found_after < 0 && result.status != track::TrackingStatus::kLost)
      found_after = static_cast<int>(i) - 10;
  }
  EXPECT_GE(found_after, 0);
  EXPECT_LE(found_after, 5);
  const Rigid3 world =
      pipeline.trajectory()[0].world_from_camera * inverse(walk().groundtruth[0].world_from_camera);
  const Rigid3 off = inverse(world * walk().groundtruth[19].world_from_camera) *
                     pipeline.trajectory().back().world_from_camera;
  EXPECT_LT(off.translation.norm(), 0.03);
  EXPECT_LT(angle_rad(off.rotation), 0.02);
}

TEST(PipelineMapping, ACameraThatIsNotFoundBeginsAPartWhichIsJoinedLater) {
  Options options = soon_stable();
  options.adjust.new_part_after_frames = 3;
  Pipeline pipeline = mapped(options);
  for (std::size_t i = 0; i < 12; ++i) process(pipeline, i);
  // Carried to where it has never been, and walked back from there.
  for (std::size_t i = 46; i > 4; --i) process(pipeline, i);
  pipeline.finish();
  ASSERT_EQ(pipeline.statistics().mapping.value().joined_components, 1);
  // What was seen of the new part before it was joined lies right as well.
  const Rigid3 world =
      pipeline.trajectory()[0].world_from_camera * inverse(walk().groundtruth[0].world_from_camera);
  const std::size_t seen_as = 12 + 6;  // frame 40
  const Rigid3 off = inverse(world * walk().groundtruth[40].world_from_camera) *
                     pipeline.trajectory()[seen_as].world_from_camera;
  EXPECT_LT(off.translation.norm(), 0.1);
}

TEST(PipelineMapping, ABoundOfDeviceMemoryHoldsAndChangesLittle) {
  Options options = soon_stable();
  options.adjust.active_path_m = 0.5;
  options.map.gpu_memory_mb = least_memory_mb() + 1;
  Pipeline pipeline = mapped(options);
  std::int64_t largest = 0;
  for (std::size_t i = 0; i < walk().frames.size(); ++i) {
    EXPECT_NE(process(pipeline, i).status, track::TrackingStatus::kLost) << "frame " << i;
    std::int64_t bytes = 0;
    for (const auto& [purpose, of_purpose] : pipeline.statistics().gpu_memory_bytes)
      bytes += of_purpose;
    largest = std::max(largest, bytes);
  }
  EXPECT_LE(largest, 1'000'000 * std::int64_t{options.map.gpu_memory_mb});
  EXPECT_GT(pipeline.statistics().host_memory_bytes, 0) << "nothing had to leave";
  EXPECT_LT(ate_rmse_m(pipeline), 0.02);
}

bool tells_of_a_full_map(const FrameResult& result) {
  return result.reason.find("the map is full") != std::string::npos;
}

// The first submap takes nearly all the room there is, until the camera has left it.
TEST(PipelineMapping, AFullMapIsTrackedAgainstAndGrowsAgainWhenThereIsRoom) {
  Options options = soon_stable();
  options.adjust.active_path_m = 0.5;
  options.map.gpu_memory_mb = least_memory_mb();
  Pipeline pipeline = mapped(options);
  const std::size_t filled = 5;
  for (std::size_t i = 0; i < filled; ++i)
    EXPECT_FALSE(tells_of_a_full_map(process(pipeline, i))) << "frame " << i;
  const std::int64_t fits = 4 * std::int64_t{walk().camera.width} * walk().camera.height - 512;
  ASSERT_TRUE(pipeline
                  .insert(test::surfels_behind(
                      static_cast<std::size_t>(fits - pipeline.statistics().surfel_slot_count)))
                  .ok());
  std::int64_t surfels = pipeline.statistics().surfel_count;
  std::size_t full_count = 0, next = filled;
  for (; next < walk().frames.size(); ++next) {
    const FrameResult result = process(pipeline, next);
    if (!tells_of_a_full_map(result)) break;
    ++full_count;
    EXPECT_EQ(result.status, track::TrackingStatus::kWeak) << "frame " << next;
    EXPECT_LE(result.surfel_count, surfels) << "frame " << next;
    surfels = result.surfel_count;
  }
  EXPECT_GE(full_count, 3u);
  for (++next; next < walk().frames.size(); ++next) {
    const FrameResult result = process(pipeline, next);
    EXPECT_EQ(result.status, track::TrackingStatus::kTracked)
        << "frame " << next << ": " << result.reason;
  }
  EXPECT_EQ(pipeline.statistics().weak_frame_count, static_cast<std::int64_t>(full_count));
  EXPECT_GT(pipeline.statistics().surfel_count, surfels + 10'000);
  EXPECT_LT(ate_rmse_m(pipeline), 0.02);
}

TEST(PipelineMapping, TooLittleMemoryIsRefusedWithTheLeastThatWouldDo) {
  Options options;
  options.map.gpu_memory_mb = least_memory_mb();
  EXPECT_GT(options.map.gpu_memory_mb, 1);
  EXPECT_NO_THROW(mapped(options));
  --options.map.gpu_memory_mb;
  EXPECT_THROW(mapped(options), SetupError);
}

}  // namespace
}  // namespace hermite::pipeline::mapping_test
