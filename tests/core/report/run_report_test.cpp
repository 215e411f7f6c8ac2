#include "core/report/run_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/report/reported_up.h"

namespace hermite::report::run_report_test {
namespace {

dataset::Trajectory straight_line(double offset_m) {
  dataset::Trajectory trajectory;
  for (int i = 0; i < 5; ++i) {
    dataset::TimedPose pose;
    pose.timestamp_s = 0.1 * i;
    pose.world_from_camera.translation = {0.1 * i, (i % 2 == 0 ? offset_m : -offset_m),
                                          0.05 * i * i};
    trajectory.push_back(pose);
  }
  return trajectory;
}

RunReport small_run() {
  RunReport run;
  run.statistics.frame_count = 5;
  run.statistics.tracked_frame_count = 4;
  run.statistics.surfel_count = 77;
  run.statistics.mean_frame_ms = 12.5;
  run.statistics.stages_ms = {{"track", 3.5}, {"fuse", 1.25}};
  run.statistics.gpu_memory_bytes = {{"map", 3'000'000}, {"frame", 500'000}};
  run.statistics.device = "a device";
  run.trajectory_text = "abc";
  run.cloud_ply = "";
  run.cloud_points = 66;
  return run;
}

TEST(Report, SaysWhatTheRunWas) {
  const auto report = nlohmann::json::parse(format_report_json(small_run(), {}, {}));
  EXPECT_EQ(report["frames"], 5);
  EXPECT_EQ(report["tracked_frames"], 4);
  EXPECT_EQ(report["surfels"], 77);
  EXPECT_EQ(report["cloud_points"], 66);
  EXPECT_EQ(report["mean_frame_ms"], 12.5);
  EXPECT_EQ(report["stages_ms"]["track"], 3.5);
  EXPECT_EQ(report["gpu_memory_mb"], 3.5);
  EXPECT_EQ(report["device"], "a device");
  EXPECT_GT(report["peak_rss_mb"].get<double>(), 1.0);
}

TEST(Report, SaysWhichWayIsUpAndIsReadAgain) {
  RunReport run = small_run();
  EXPECT_FALSE(up_in_report(format_report_json(run, {}, {})).has_value());
  run.statistics.up = UpDirection{Eigen::Vector3d(0.1, -0.9, 0.3).normalized(), 0.02};
  const auto up = up_in_report(format_report_json(run, {}, {}));
  ASSERT_TRUE(up.has_value());
  EXPECT_LT((up->in_world - run.statistics.up->in_world).norm(), 1e-9);
  EXPECT_NEAR(up->sigma_rad, 0.02, 1e-9);
  run.statistics.up.reset();
  run.statistics.up_problem = "it is not known";
  EXPECT_EQ(nlohmann::json::parse(format_report_json(run, {}, {}))["up_problem"],
            "it is not known");
}

TEST(Report, WithoutAUsableDirectionNoneIsRead) {
  for (const char* wrong :
       {"", "[]", "3", "{}", R"({"up": 1})", R"({"up": {"in_world": [0, -1, 0]}})",
        R"({"up": {"in_world": [0, -2, 0], "sigma_deg": 1}})",
        R"({"up": {"in_world": [0, -1], "sigma_deg": 1}})",
        R"({"up": {"in_world": [0, -1, "0"], "sigma_deg": 1}})",
        R"({"up": {"in_world": [0, -1, 0], "sigma_deg": -1}})",
        R"({"up": {"in_world": [0, -1, 0], "sigma_deg": null}})"})
    EXPECT_FALSE(up_in_report(wrong).has_value()) << wrong;
  EXPECT_TRUE(up_in_report(R"({"up": {"in_world": [0, -1, 0], "sigma_deg": 1}})").has_value());
}

TEST(Report, HashesAreSha256OfTheExactBytes) {
  const auto report = nlohmann::json::parse(format_report_json(small_run(), {}, {}));
  // The two best known digests (FIPS 180-4 examples).
  EXPECT_EQ(report["trajectory_sha256"],
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(report["cloud_sha256"],
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Report, HoldsEverySettingAsANumberWhereItIsOne) {
  RunReport run = small_run();
  ASSERT_TRUE(pipeline::apply_setting(run.options, "frame.depth_max_m", "2.5").ok());
  const auto report = nlohmann::json::parse(format_report_json(run, {}, {}));
  ASSERT_EQ(report["settings"].size(), pipeline::list_settings(run.options).size());
  EXPECT_EQ(report["settings"]["frame.depth_max_m"], 2.5);
}

TEST(Report, WithoutGroundTruthThereIsNoAccuracy) {
  const auto report = nlohmann::json::parse(format_report_json(small_run(), straight_line(0), {}));
  EXPECT_FALSE(report.contains("ate_rmse_m"));
  EXPECT_FALSE(report.contains("groundtruth_problem"));
}

TEST(Report, WithGroundTruthItStatesTheErrors) {
  const auto exact =
      nlohmann::json::parse(format_report_json(small_run(), straight_line(0), straight_line(0)));
  EXPECT_NEAR(exact["ate_rmse_m"].get<double>(), 0, 1e-9);
  const auto off =
      nlohmann::json::parse(format_report_json(small_run(), straight_line(0.01), straight_line(0)));
  EXPECT_GT(off["ate_rmse_m"].get<double>(), 0.005);
  EXPECT_GE(off["ate_max_m"].get<double>(), off["ate_rmse_m"].get<double>());
  EXPECT_GT(off["rpe_translation_rmse_m"].get<double>(), 0.01);
  EXPECT_NEAR(off["rpe_rotation_rmse_deg"].get<double>(), 0, 1e-6);
}

TEST(Report, AGroundTruthOfAnotherTimeIsAProblemWithAMessage) {
  dataset::Trajectory elsewhere = straight_line(0);
  for (dataset::TimedPose& pose : elsewhere) pose.timestamp_s += 1000;
  const auto report =
      nlohmann::json::parse(format_report_json(small_run(), straight_line(0), elsewhere));
  EXPECT_FALSE(report.contains("ate_rmse_m"));
  EXPECT_FALSE(report["groundtruth_problem"].get<std::string>().empty());
}

}  // namespace
}  // namespace hermite::report::run_report_test
