#include "core/measure/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/output/ply.h"

namespace hermite {
namespace measure_test {

using ::testing::HasSubstr;

// Two walls, 1.5 m apart, before a camera that sees both.
std::string surfels_of_walls() {
  Cloud cloud;
  for (const float z : {1.0f, 2.5f})
    for (int i = -10; i <= 10; ++i)
      for (int j = -10; j <= 10; ++j) {
        CloudPoint point;
        point.position_m = {0.01f * static_cast<float>(i), 0.01f * static_cast<float>(j), z};
        point.normal = {0, 0, -1};
        point.confidence = 5;
        cloud.push_back(point);
      }
  return format_ply(cloud);
}

ReadPart part_of(std::string bytes) {
  return [bytes = std::move(bytes)](std::uint64_t offset, std::size_t max_bytes) -> Result<std::string> {
    return offset < bytes.size() ? bytes.substr(offset, max_bytes) : std::string();
  };
}

const std::string kTrajectory = "0.0 0 0 0 0 0 0 1\n";

TEST(Measure, ADistanceComesFromTheFilesOfAResult) {
  const MeasuredResult result{part_of(surfels_of_walls()), or_throw(map_knowledge_of(kTrajectory, R"({"mapping": {"parts": 1}})"))};
  const Result<Measurement> found = measure_distance(result, {0, 0, 1.004}, {0, 0, 2.497});
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_NEAR(found->distance.distance_m, 1.5, 1e-5);
  const nlohmann::json json = nlohmann::json::parse(format_measurement_json(*found));
  EXPECT_EQ(json["confidence"], 0.95);
  EXPECT_EQ(json["words"], words_of(found->distance));
  EXPECT_NEAR(json["from"][2].get<double>(), 1, 1e-5);
  EXPECT_NEAR(json["to_normal"][2].get<double>(), -1, 1e-5);
  EXPECT_GT(json["half_width_m"].get<double>(), 0);
}

TEST(Measure, ErrorsNameThePoint) {
  const MeasuredResult result{part_of(surfels_of_walls()), or_throw(map_knowledge_of(kTrajectory, "{}"))};
  const auto words = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Result<Measurement> found = measure_distance(result, from, to);
    return found.ok() ? std::string() : found.error().message;
  };
  EXPECT_THAT(words({0, 0, 1}, {0, 0, 1.7}), HasSubstr("to: no surface"));
  EXPECT_THAT(words({3, 0, 1}, {0, 0, 1}), HasSubstr("from: no surface"));
  EXPECT_THAT(words({0, 0, 1}, {0, std::numeric_limits<double>::infinity(), 1}), HasSubstr("to: not three finite"));
  EXPECT_THAT(words({0, 0, 1}, {1e30, 0, 1}), HasSubstr("to: no surface"));
  EXPECT_THAT(words({0, 0, 1}, {0, 0, 1.001}), HasSubstr("same place"));
}

TEST(Measure, DamagedFilesAreSaidToBe) {
  EXPECT_EQ(map_knowledge_of("nonsense", "{}").error().code, ErrorCode::kCorruptData);
  EXPECT_EQ(map_knowledge_of(kTrajectory, "[").error().code, ErrorCode::kCorruptData);
  EXPECT_TRUE(or_throw(map_knowledge_of(kTrajectory, R"({"corrected_camera": {}})")).camera_was_corrected);
  EXPECT_EQ(or_throw(map_knowledge_of(kTrajectory, R"({"mapping": {"parts": 3}})")).part_count, 3);
  const MeasuredResult cut{part_of(surfels_of_walls().substr(0, 9000)), or_throw(map_knowledge_of(kTrajectory, "{}"))};
  EXPECT_EQ(measure_distance(cut, {0, 0, 1}, {0, 0, 2.5}).error().code, ErrorCode::kCorruptData);
}

}  // namespace measure_test
}  // namespace hermite
