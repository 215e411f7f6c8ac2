#include "server/client/activity_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace hermite::client::activity_text_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

RunningScan scan_called(const std::string& title, std::optional<double> frames_per_s) {
  RunningScan row;
  row.scan.id = "abcdefghijklmnopqrstuvwxyz";
  row.scan.title = title;
  row.scan.created_at = "2024-05-01T12:34:56.123Z";
  row.scan.frames_processed = 1840;
  row.scan.frames_dropped = 7;
  row.waiting_frames = 3;
  row.frames_per_s = frames_per_s;
  return row;
}

JobReport job_called(const std::string& title, const std::string& state) {
  JobReport job;
  job.id = "zyxwvutsrqponmlkjihgfedcba";
  job.title = title;
  job.state = state;
  return job;
}

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(ActivityText, SaysWhatRunsAndWhatWaits) {
  Activity activity;
  activity.scans = {scan_called("Chair", 29.94), scan_called("Kitchen", std::nullopt)};
  JobReport running = job_called("Hall", "running");
  running.stage = "tracking";
  running.done = 412;
  running.total = 1000;
  activity.jobs = {job_called("Later", "queued"), running};
  activity.load = ServerLoad{2, 1, 1.2e9, 8e9, 81e9, false, false, 0.072};
  const std::string text = activity_text(activity, "host:80", "12:00:00", {});
  EXPECT_THAT(
      text,
      StartsWith("host:80  12:00:00  2 scans running, 29.9 frames/s; 1 job running, "
                 "1 waiting\n2 viewers, 1 camera waiting for a place; GPU memory 1.2 of 8.0 GB; "
                 "81.0 GB of disk free; 72 ms from"));
  EXPECT_THAT(text, HasSubstr("    29.9       3       7     1840  05-01 12:34  Chair" +
                              std::string(37, ' ') + "abcdefghijklmnopqrstuvwxyz\n"));
  EXPECT_THAT(text, HasSubstr("       -       3 ")) << "a rate that is not known yet";
  EXPECT_THAT(text, HasSubstr("    41 %  tracking                  Hall "));
  EXPECT_LT(text.find("Hall"), text.find("Later")) << "what runs stands above what waits";
}

TEST(ActivityText, SaysWhatTheServerSuffersFrom) {
  Activity activity;
  activity.load = ServerLoad{};
  activity.load->is_draining = activity.load->is_database_damaged = true;
  const std::string text = activity_text(activity, "host:80", "12:00:00", {});
  EXPECT_THAT(text, HasSubstr("0 scans running, 0.0 frames/s; the token may not see jobs\n"));
  EXPECT_THAT(text, HasSubstr("draining"));
  EXPECT_THAT(text, HasSubstr("DATABASE IS DAMAGED"));
  EXPECT_THAT(text, Not(HasSubstr("ms from"))) << "no frame, no latency";
}

TEST(ActivityText, FitsTheTerminal) {
  Activity activity;
  activity.jobs.emplace();
  for (int i = 0; i < 30; ++i) activity.scans.push_back(scan_called("Küche", 1.0));
  const std::string text = activity_text(activity, "host:80", "12:00:00", {50, 10});
  EXPECT_EQ(line_count(text), 10u);
  EXPECT_THAT(text, HasSubstr("05-01 12:34  Kü\n")) << "characters, not bytes";
  EXPECT_THAT(text, HasSubstr("... and 24 lines more\n"));
}

TEST(ActivityText, LetsNoTitleMoveTheCursor) {
  Activity activity;
  activity.scans = {scan_called("a\x1b[2Jb", 1.0)};
  JobReport job = job_called("c\rd", "queued");
  job.message = "e\nf";
  activity.jobs = {job};
  const std::string text = activity_text(activity, "host:80", "12:00:00", {});
  EXPECT_THAT(text, HasSubstr("a?[2Jb "));
  EXPECT_THAT(text, HasSubstr("c?d "));
  EXPECT_THAT(text, HasSubstr("  e?f\n"));
}

}  // namespace
}  // namespace hermite::client::activity_text_test
