#include "core/dataset/accelerometer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/dataset/camera_file.h"
#include "core/dataset/recording.h"
#include "core/dataset/write_tum.h"
#include "core/source/open_sequence.h"
#include "tests/core/dataset/temp_folder.h"
#include "tests/support/file_bytes.h"

namespace hermite::dataset::accelerometer_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const WriteProgress kSilent = [](std::int64_t) {};

TEST(Accelerometer, ListsAreReadInAnyOrderAndBadLinesNamed) {
  const auto felt = parse_accelerations("# accelerometer data\n2 4 5 6\n\n1.5 -1 0.25 9.8\n");
  ASSERT_TRUE(felt.ok()) << felt.error().message;
  ASSERT_EQ(felt->size(), 2u);
  EXPECT_EQ(felt->front().timestamp_s, 1.5);
  EXPECT_EQ(felt->front().acceleration_m_s2, Eigen::Vector3d(-1, 0.25, 9.8));
  EXPECT_EQ(parse_accelerations(format_accelerations(*felt))->back().acceleration_m_s2,
            Eigen::Vector3d(4, 5, 6));
  for (const char* wrong : {"1 2 3", "1 2 3 4 5", "1 2 3 x", "1 2 3 nan"})
    EXPECT_THAT(parse_accelerations(std::string("0 0 0 9.8\n") + wrong).error().message,
                testing::AllOf(HasSubstr("accelerometer.txt"), HasSubstr("line 2")))
        << wrong;
}

TEST(Accelerometer, AxesOfACameraFileAreARotation) {
  const auto with = [](const std::string& axes) {
    return parse_camera_json(
        R"({"width": 64, "height": 64, "fx": 60, "fy": 60, "cx": 32, "cy": 32, )"
        R"("depth_units_per_metre": 1000, "camera_from_accelerometer": )" +
        axes + "}");
  };
  const auto file = with("[[0, 1, 0], [0, 0, 1], [1, 0, 0]]");
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(*file->camera_from_accelerometer * Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(2, 3, 1));
  const auto again = parse_camera_json(format_camera_json(*file));
  EXPECT_EQ(*again->camera_from_accelerometer, *file->camera_from_accelerometer);
  EXPECT_THAT(with("[[0, 1, 0], [0, 0, 1]]").error().message,
              HasSubstr("camera_from_accelerometer\" must be three rows of three numbers"));
  EXPECT_THAT(with("[[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0]]").error().message,
              HasSubstr("camera_from_accelerometer\" must be three rows of three numbers"));
  EXPECT_THAT(with("[[1, 0, 0], [0, 1, 0], [0, 0, -1]]").error().message,
              HasSubstr("camera_from_accelerometer\" is no rotation"));
  EXPECT_THAT(with("null").error().message, HasSubstr("camera_from_accelerometer"));
}

TEST(Accelerometer, AFrameHasTheMeanSinceTheOneBefore) {
  const auto at = [](double time_s, double up_m_s2) {
    return TimedAcceleration{time_s, {0, up_m_s2, 0}};
  };
  const auto means =
      felt_before({1.0, 1.05, 1.06, 2.0}, {at(0.5, 100), at(0.95, 1), at(1.0, 3), at(1.01, 5),
                                           at(1.02, 7), at(1.5, 100), at(1.95, 11), at(2.01, 100)});
  ASSERT_EQ(means.size(), 4u);
  EXPECT_EQ(means[0]->y(), 2);
  EXPECT_EQ(means[1]->y(), 6);
  EXPECT_FALSE(means[2].has_value());
  EXPECT_EQ(means[3]->y(), 11) << "what is long past was another motion";
  EXPECT_FALSE(felt_before({1.0}, {})[0].has_value());
}

// A recording of five frames with an accelerometer, as written here.
class WrittenRecording : public testing::Test {
 protected:
  void SetUp() override {
    source_ = *source::open_sequence(
        "synthetic:frames=5,width=96,height=72+accelerometer=noise_m_s2=0.5");
    ASSERT_TRUE(write_tum(*source_, {0, 5}, folder_.path("out"), kSilent).ok());
  }
  std::string text(const std::string& name) const {
    const std::vector<std::uint8_t> bytes = test::file_bytes(folder_.path("out/" + name));
    return {bytes.begin(), bytes.end()};
  }
  // What is felt before frame 2, and what is doubted.
  std::optional<Eigen::Vector3d> felt() {
    const auto recording = open_recording(folder_.path("out"));
    EXPECT_TRUE(recording.ok()) << recording.error().message;
    doubts_ = recording->doubts;
    return recording->sequence->read(2)->acceleration_m_s2;
  }

  const TempFolder folder_;
  std::unique_ptr<Sequence> source_;
  std::vector<std::string> doubts_;
};

TEST_F(WrittenRecording, FeelsWhatItsSourceDid) {
  const Eigen::Vector3d expected = *source_->read(2)->acceleration_m_s2;
  EXPECT_GT(expected.norm(), 5);
  EXPECT_EQ(*felt(), expected);
  EXPECT_THAT(doubts_, IsEmpty());
}

TEST_F(WrittenRecording, TakesTheAxesThatItsCameraFileSays) {
  const Eigen::Vector3d before = *felt();
  nlohmann::json camera = nlohmann::json::parse(text("camera.json"));
  camera["camera_from_accelerometer"] = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
  folder_.write("out/camera.json", camera.dump());
  EXPECT_EQ(*felt(), Eigen::Vector3d(before.y(), -before.x(), before.z()));
}

TEST_F(WrittenRecording, WithoutKnownAxesIsNotUsedAndSaysSo) {
  folder_.write("out/camera.json",
                format_camera_json({source_->camera(), source_->frame_rate_hz(), true, {}}));
  EXPECT_FALSE(felt().has_value());
  EXPECT_THAT(doubts_, testing::ElementsAre(HasSubstr("camera_from_accelerometer")));
}

TEST_F(WrittenRecording, OfTheBenchmarkHasTheKinectsAxes) {
  const Eigen::Vector3d before = *felt();
  folder_.write("out/camera.json",
                format_camera_json({source_->camera(), source_->frame_rate_hz(), true, {}}));
  folder_.write("out/accelerometer.txt",
                "# accelerometer data\n# file: 'rgbd_dataset_freiburg1_desk.bag'\n" +
                    text("accelerometer.txt"));
  EXPECT_EQ(*felt(), Eigen::Vector3d(-before.x(), -before.y(), before.z()));
}

TEST_F(WrittenRecording, WithADamagedListIsARecordingStill) {
  folder_.write("out/accelerometer.txt", "0 1 2\n");
  EXPECT_FALSE(felt().has_value());
  EXPECT_THAT(doubts_,
              testing::ElementsAre(testing::AllOf(HasSubstr("line 1"), HasSubstr("is not used"))));
}

}  // namespace
}  // namespace hermite::dataset::accelerometer_test
