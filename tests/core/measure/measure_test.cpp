#include "core/measure/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "tests/support/two_walls.h"

namespace hermite::measure {
namespace measure_test {

using ::testing::HasSubstr;

using Eigen::Vector3d;

EachPoint points_of(output::Cloud cloud) {
  return [cloud = std::move(cloud)](
             const std::function<void(const output::CloudPoint&)>& use) -> Status {
    for (const output::CloudPoint& point : cloud) use(point);
    return Done{};
  };
}

const std::string kTrajectory = "0.0 0 0 0 0 0 0 1\n";

MeasuredResult two_walls() {
  return {points_of(test::two_walls()),
          or_throw(map_knowledge_of(kTrajectory, R"({"mapping": {"parts": 1}})"))};
}

MeasureRequest request(MeasureKind kind, std::vector<Vector3d> points,
                       std::optional<Vector3d> up = std::nullopt) {
  return {kind, std::move(points), up};
}

Measurement measured(const MeasureRequest& asked) {
  const Result<Measurement> found = measure(two_walls(), asked);
  EXPECT_TRUE(found.ok()) << found.error().message;
  return found.ok() ? *found : Measurement{};
}

TEST(Measure, ADistanceComesFromTheFilesOfAResult) {
  const Measurement found =
      measured(request(MeasureKind::kDistance, {{0, 0, 1.004}, {0, 0, 2.497}}));
  EXPECT_NEAR(found.quantity.value, 1.5, 1e-5);
  const nlohmann::json json = nlohmann::json::parse(format_measurement_json(found));
  EXPECT_EQ(json["kind"], "distance");
  EXPECT_EQ(json["unit"], "m");
  EXPECT_EQ(json["confidence"], 0.95);
  EXPECT_EQ(json["words"], text_of(found.quantity));
  EXPECT_NEAR(json["points"][0][2].get<double>(), 1, 1e-5);
  EXPECT_NEAR(json["normals"][1][2].get<double>(), -1, 1e-5);
  EXPECT_GT(json["half_width"].get<double>(), 0);
  EXPECT_FALSE(json.contains("up"));
}

TEST(Measure, EveryKindDoes) {
  EXPECT_NEAR(
      measured(request(MeasureKind::kPlane, {{0.03, 0.04, 1.002}, {0, 0, 2.501}})).quantity.value,
      1.5, 1e-4);
  const Measurement height = measured(
      request(MeasureKind::kHeight, {{0, 0.05, 1}, {0.04, -0.03, 2.5}}, Vector3d(0, -1.005, 0)));
  EXPECT_NEAR(height.quantity.value, 0.08, 1e-6);
  EXPECT_EQ(nlohmann::json::parse(format_measurement_json(height))["up"][1], -1);
  EXPECT_NEAR(measured(request(MeasureKind::kAngle, {{0, 0, 1}, {0.02, 0, 2.5}})).quantity.value,
              180, 0.1);
  const std::vector<Vector3d> corners{
      {-0.1, -0.1, 1}, {0.1, -0.1, 1.003}, {0.1, 0.1, 1}, {-0.1, 0.1, 0.998}};
  const Measurement area = measured(request(MeasureKind::kArea, corners));
  EXPECT_NEAR(area.quantity.value, 0.04, 1e-5);
  EXPECT_EQ(area.places.size(), 4u);
}

TEST(Measure, ErrorsNameThePoint) {
  const auto message_of = [](const MeasureRequest& asked) {
    const Result<Measurement> found = measure(two_walls(), asked);
    return found.ok() ? std::string() : found.error().message;
  };
  const auto distance = [&](const Vector3d& from, const Vector3d& to) {
    return message_of(request(MeasureKind::kDistance, {from, to}));
  };
  EXPECT_THAT(distance({0, 0, 1}, {0, 0, 1.7}), HasSubstr("points[1]: no surface"));
  EXPECT_THAT(distance({3, 0, 1}, {0, 0, 1}), HasSubstr("points[0]: no surface"));
  EXPECT_THAT(distance({0, 0, 1}, {0, std::numeric_limits<double>::infinity(), 1}),
              HasSubstr("points[1] is not three finite"));
  EXPECT_THAT(distance({0, 0, 1}, {1e30, 0, 1}), HasSubstr("points[1]: no surface"));
  EXPECT_THAT(distance({0, 0, 1}, {0, 0, 1.001}), HasSubstr("same place"));
}

TEST(Measure, RequestsAreCheckedAndTheLimitSaid) {
  const auto message_of = [](const MeasureRequest& asked) {
    const Status status = check_measure_request(asked);
    return status.ok() ? std::string() : status.error().message;
  };
  const std::vector<Vector3d> two{{0, 0, 1}, {0, 0, 2.5}};
  EXPECT_EQ(message_of(request(MeasureKind::kAngle, two)), "");
  EXPECT_EQ(message_of(request(MeasureKind::kDistance, {{0, 0, 1}})),
            "points has 1 points, of kind distance are allowed 2");
  EXPECT_EQ(message_of(request(MeasureKind::kArea, two)),
            "points has 2 points, of kind area are allowed 3 to 64");
  EXPECT_THAT(message_of(request(MeasureKind::kHeight, two)), HasSubstr("up is missing"));
  EXPECT_THAT(message_of(request(MeasureKind::kAngle, two, Vector3d(0, -1, 0))),
              HasSubstr("up belongs to kind height"));
  EXPECT_THAT(message_of(request(MeasureKind::kHeight, two, Vector3d(0, -2, 0))),
              HasSubstr("its length is 2, allowed are 0.99 to 1.01"));
  EXPECT_THAT(message_of(request(MeasureKind::kHeight, two,
                                 Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()))),
              HasSubstr("unit vector"));
}

TEST(Measure, DamagedFilesAreSaidToBe) {
  EXPECT_EQ(map_knowledge_of("nonsense", "{}").error().code, ErrorCode::kCorruptData);
  EXPECT_EQ(map_knowledge_of(kTrajectory, "[").error().code, ErrorCode::kCorruptData);
  EXPECT_TRUE(
      or_throw(map_knowledge_of(kTrajectory, R"({"corrected_camera": {}})")).camera_was_corrected);
  EXPECT_EQ(or_throw(map_knowledge_of(kTrajectory, R"({"mapping": {"parts": 3}})")).part_count, 3);
  EXPECT_NEAR(or_throw(map_knowledge_of(kTrajectory,
                                        R"({"expected_error": {"path_m": 0.05, "stall_m": 0.03}})"))
                  .expected_path_m,
              0.04, 1e-12)
      << "frames with repeated depth add nothing to the map";
  for (const char* odd :
       {R"({"expected_error": 3})", R"({"expected_error": {"path_m": "3"}})",
        R"({"expected_error": {"path_m": 1e200}})", R"({"expected_error": {"path_m": -3}})", "{}"})
    EXPECT_EQ(or_throw(map_knowledge_of(kTrajectory, odd)).expected_path_m, 0) << odd;
  MeasuredResult cut = two_walls();
  cut.each_point = [](const std::function<void(const output::CloudPoint&)>&) -> Status {
    return Error{ErrorCode::kCorruptData, "cut"};
  };
  EXPECT_EQ(measure(cut, request(MeasureKind::kDistance, {{0, 0, 1}, {0, 0, 2.5}})).error().code,
            ErrorCode::kCorruptData);
}

}  // namespace measure_test
}  // namespace hermite::measure
