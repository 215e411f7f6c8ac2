#include "server/jobs/job_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proto/wire/messages.h"
#include "server/net/base64.h"
#include "server/store/scan_id.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

UploadRow upload_with(const std::vector<std::pair<std::string, std::string>>& metadata) {
  UploadRow row;
  row.id = new_scan_id();
  row.token_id = "t";
  for (const auto& [key, value] : metadata)
    row.metadata += (row.metadata.empty() ? "" : ",") + key + " " + encode_base64(value);
  return row;
}

std::string refusal_of(const std::vector<std::pair<std::string, std::string>>& metadata) {
  const Result<JobRow> job = job_of_upload(upload_with(metadata));
  return job.ok() ? "well" : job.error().message;
}

TEST(JobRequest, AnUploadsJobHasItsIdAndWhatItsMetadataSays) {
  const UploadRow upload = upload_with({{"filename", "kitchen.tar.zst"},
                                        {"camera", "fr1"},
                                        {"settings", R"({"map.stable_confidence": "1"})"},
                                        {"priority", "-7"},
                                        {"unknown", "is left alone"}});
  const Result<JobRow> job = job_of_upload(upload);
  ASSERT_TRUE(job.ok()) << job.error().message;
  EXPECT_EQ(job->id, upload.id);
  EXPECT_EQ(job->source_id, upload.id);
  EXPECT_EQ(job->token_id, "t");
  EXPECT_EQ(job->title, "kitchen");
  EXPECT_EQ(job->camera, "fr1");
  EXPECT_EQ(job->priority, -7);
  EXPECT_THAT(settings_of(*job), testing::ElementsAre(testing::Pair("map.stable_confidence", "1")));
}

TEST(JobRequest, NothingHasToBeSaid) { EXPECT_EQ(refusal_of({}), "well"); }

TEST(JobRequest, WhatIsWrongIsNamed) {
  EXPECT_THAT(refusal_of({{"priority", "101"}}),
              HasSubstr("priority must be a whole number from -100 to 100"));
  EXPECT_THAT(refusal_of({{"priority", "NaN"}}), HasSubstr("priority"));
  EXPECT_THAT(refusal_of({{"settings", "[1]"}}),
              HasSubstr("settings must be a JSON object of strings"));
  EXPECT_THAT(refusal_of({{"settings", R"({"a": 1})"}}), HasSubstr("not a string"));
  EXPECT_THAT(refusal_of({{"settings", R"({"no.such": "1"})"}}), HasSubstr("no.such"));
  EXPECT_THAT(refusal_of({{"settings", R"({"up": "x"})"}}),
              HasSubstr("settings: up must be y, z or -y"));
  EXPECT_EQ(refusal_of({{"settings", R"({"up": "y", "scale": "0.001"})"}}), "well")
      << "of an import";
  EXPECT_THAT(refusal_of({{"camera", "fr9"}}), HasSubstr("camera"));
  EXPECT_THAT(refusal_of({{"camera", R"({"width": 640})"}}), HasSubstr("height"));
}

TEST(JobRequest, AStoredScanIsAskedForById) {
  const std::string scan = new_scan_id();
  const Result<JobRow> job = job_of_request(
      R"({"scan": ")" + scan +
      R"(", "title": "again", "settings": {"map.stable_confidence": "1"}, "priority": 3})");
  ASSERT_TRUE(job.ok()) << job.error().message;
  EXPECT_EQ(job->source, JobSource::kScan);
  EXPECT_EQ(job->source_id, scan);
  EXPECT_EQ(job->title, "again");
  EXPECT_EQ(job->priority, 3);
  EXPECT_TRUE(check_priority(*job, true).ok());
  EXPECT_EQ(check_priority(*job, false).error().code, ErrorCode::kUnauthorized);
  EXPECT_TRUE(check_priority(JobRow(), false).ok());
  for (const std::string& body :
       {std::string(), std::string("[]"), std::string("{}"), std::string(R"({"scan": "../x"})"),
        R"({"scan": ")" + scan + R"(", "setings": {}})",
        R"({"scan": ")" + scan + R"(", "priority": 1.5})"})
    EXPECT_EQ(job_of_request(body).error().code, ErrorCode::kInvalidArgument) << body;
}

TEST(JobRequest, TitlesAreTextsWithoutControlCharacters) {
  EXPECT_EQ(clean_title("Küche №5"), "Küche №5");
  EXPECT_EQ(clean_title("a\nb\x7f"), "a?b?");
  EXPECT_EQ(clean_title("\xff\xc3"), "??");
  EXPECT_EQ(clean_title("\xed\xa0\x80"), "???") << "a surrogate is no character";
  EXPECT_EQ(clean_title("\xc0\x80"), "??");
  std::string longest;
  for (int i = 0; i < 300; ++i) longest += "ü";
  EXPECT_EQ(clean_title(longest).size(), wire::kMaxTitleBytes);
}

TEST(JobRequest, AJobThatCameToNothingHasNoScan) {
  JobStatus job;
  job.row.scan_id = new_scan_id();
  job.row.state = JobState::kFailed;
  job.row.message = "no \xff camera";
  const nlohmann::json json = nlohmann::json::parse(job_json(job, {{1000, "line"}}));
  EXPECT_TRUE(json["scan"].is_null());
  EXPECT_EQ(json["state"], "failed");
  EXPECT_EQ(json["log"][0]["words"], "line");
  job.row.state = JobState::kRunning;
  job.stage = {"tracking", 3, 10};
  const nlohmann::json running = nlohmann::json::parse(jobs_json({job}))["jobs"][0];
  EXPECT_EQ(running["scan"], job.row.scan_id);
  EXPECT_EQ(running["stage"], "tracking");
  EXPECT_EQ(running["done"], 3);
}

}  // namespace
}  // namespace hermite::server
