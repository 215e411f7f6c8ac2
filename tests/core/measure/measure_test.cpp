#include "core/measure/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/output/ply.h"
#include "tests/support/two_walls.h"

namespace hermite {
namespace measure_test {

using ::testing::HasSubstr;

ReadPart part_of(std::string bytes) {
  return [bytes = std::move(bytes)](std::uint64_t offset, std::size_t max_bytes) -> Result<std::string> {
    return offset < bytes.size() ? bytes.substr(offset, max_bytes) : std::string();
  };
}

const std::string kTrajectory = "0.0 0 0 0 0 0 0 1\n";

TEST(Measure, ADistanceComesFromTheFilesOfAResult) {
  const MeasuredResult result{part_of(format_ply(test::two_walls())),
                              or_throw(map_knowledge_of(kTrajectory, R"({"mapping": {"parts": 1}})"))};
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
  const MeasuredResult result{part_of(format_ply(test::two_walls())), or_throw(map_knowledge_of(kTrajectory, "{}"))};
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
  const MeasuredResult cut{part_of(format_ply(test::two_walls()).substr(0, 9000)), or_throw(map_knowledge_of(kTrajectory, "{}"))};
  EXPECT_EQ(measure_distance(cut, {0, 0, 1}, {0, 0, 2.5}).error().code, ErrorCode::kCorruptData);
}

}  // namespace measure_test
}  // namespace hermite
