#include "core/evaluate/accuracy_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace hermite::evaluate {
namespace {

using Json = nlohmann::ordered_json;

// Along x, 0.1 m a frame, 30 Hz; the estimate is off by +-`wobble_m` in y in turn.
dataset::Trajectory line(double wobble_m) {
  dataset::Trajectory trajectory;
  for (int k = 0; k < 10; ++k) {
    dataset::TimedPose pose;
    pose.timestamp_s = k / 30.0;
    pose.world_from_camera.translation = {0.1 * k, k % 2 == 0 ? wobble_m : -wobble_m, 0};
    trajectory.push_back(pose);
  }
  return trajectory;
}

TEST(AccuracyReport, AddsTheKeysOfReportJsonAndKeepsTheOthersInPlace) {
  const auto text =
      add_accuracy(R"({"surfels": 7, "device": "x", "frames": 10})", line(0), line(0));
  ASSERT_TRUE(text.ok()) << text.error().message;
  const Json report = Json::parse(*text);
  EXPECT_EQ(report.begin().key(), "surfels");
  EXPECT_EQ(report["frames"], 10);
  for (const char* key :
       {"ate_rmse_m", "ate_max_m", "rpe_translation_rmse_m", "rpe_rotation_rmse_deg"}) {
    ASSERT_TRUE(report.contains(key)) << key;
    EXPECT_NEAR(report[key].get<double>(), 0, 1e-6) << key;
  }
  EXPECT_EQ(report["groundtruth_matched_frames"], 10);
}

TEST(AccuracyReport, NumbersAreThoseOfTheTrajectory) {
  const Json report = Json::parse(*add_accuracy("{}", line(0.01), line(0)));
  // The wobble is all but orthogonal to what an alignment can take away.
  EXPECT_NEAR(report["ate_rmse_m"].get<double>(), 0.01, 5e-4);
  EXPECT_NEAR(report["rpe_translation_rmse_m"].get<double>(), 0.02, 1e-6);
}

TEST(AccuracyReport, TextThatIsNoUtf8IsRefusedAndNotThrown) {
  EXPECT_TRUE(add_accuracy("{\"device\": \"gpu\"}", line(0), line(0)).ok());
  EXPECT_FALSE(add_accuracy("{\"device\": \"\xff\"}", line(0), line(0)).ok());
}

TEST(AccuracyReport, WhatIsNoObjectIsRefused) {
  for (const char* text : {"", "[]", "7", "{", "{} {}"}) {
    const auto report = add_accuracy(text, line(0), line(0));
    ASSERT_FALSE(report.ok()) << text;
    EXPECT_EQ(report.error().code, ErrorCode::kCorruptData);
  }
}

TEST(AccuracyReport, TooFewMatchingPosesAreAProblemWithAMessage) {
  dataset::Trajectory elsewhere = line(0);
  for (dataset::TimedPose& pose : elsewhere) pose.timestamp_s += 1000;
  const Json report = Json::parse(*add_accuracy("{}", line(0), elsewhere));
  EXPECT_FALSE(report.contains("ate_rmse_m"));
  EXPECT_NE(report["groundtruth_problem"].get<std::string>(), "");
}

TEST(AccuracyReport, WithoutAGroundTruthNothingIsAdded) {
  EXPECT_EQ(*add_accuracy("{\"a\": 1}", line(0), {}), "{\n  \"a\": 1\n}\n");
}

}  // namespace
}  // namespace hermite::evaluate
