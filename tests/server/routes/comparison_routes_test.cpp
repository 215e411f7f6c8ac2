// Comparisons over HTTP, of a real server. What becomes of them otherwise: tests/server/exports.
#include "server/routes/comparison_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/output/ply.h"
#include "server/store/scan_id.h"
#include "tests/core/compare/made_corner.h"
#include "tests/support/route_test.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class ComparisonRoutesTest : public test::RouteTest {
 protected:
  ComparisonRoutesTest() {
    ScanRow first = test::finished_row(first_), second = test::finished_row(second_);
    first.finished_at_ms = second.finished_at_ms = 1'700'000'000'000;
    add_scans({first, second});
    for (const std::string& id : {first_, second_})
      put(id, "cloud.ply",
          output::format_ply(test::corner_cloud(test::usual_boxes(), id == first_ ? 1 : 2, 0.02)));
    start();
  }
  using Answer = test::RouteAnswer;
  Answer ask(const std::string& method, const std::string& path, const std::string& token,
             const std::string& body = "") const {
    return RouteTest::ask(method, "/api/v1/" + path, token, body);
  }
  Answer post(const std::string& token) {
    return ask("POST", comparisons(), token, Json{{"with", second_}}.dump());
  }
  std::string comparisons() const { return "scans/" + first_ + "/comparisons"; }
  std::string comparison() const { return comparisons() + "/" + second_; }
  std::string points() const { return "scans/" + first_ + "/compared-points/" + second_; }
  Json when_over() {
    for (int i = 0; i < 12'000; ++i) {
      const Json json = ask("GET", comparison(), server_->token()).json();
      if (json["state"] != "queued" && json["state"] != "running") return json;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {};
  }

  const std::string first_ = new_scan_id(), second_ = new_scan_id();
};

TEST_F(ComparisonRoutesTest, OneIsAskedForLookedAtAndRemoved) {
  const std::string& token = server_->token();
  EXPECT_EQ(ask("GET", comparison(), token).json()["state"], "missing");
  EXPECT_EQ(ask("GET", points(), token).status, 404);
  const Answer asked = post(token);
  EXPECT_EQ(asked.status, 202) << asked.body;
  EXPECT_EQ(asked.json()["with"], second_);
  const Json ready = when_over();
  ASSERT_EQ(ready["state"], "ready") << ready;
  EXPECT_EQ(ready["report"]["verdict"], "same_place") << ready;
  EXPECT_EQ(ready["report"]["a_from_b"].size(), 4u);
  EXPECT_TRUE(ready["report"]["regions"].is_array());
  EXPECT_EQ(post(token).status, 200);
  const Answer ply = ask("GET", points(), token);
  EXPECT_EQ(ply.status, 200);
  EXPECT_TRUE(ply.body.starts_with("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_EQ(ask("GET", comparisons(), token).json()["comparisons"].size(), 1u);
  EXPECT_EQ(ask("DELETE", comparison(), token).json()["removed"], second_);
  EXPECT_EQ(ask("DELETE", comparison(), token).status, 404);
  EXPECT_TRUE(ask("GET", comparisons(), token).json()["comparisons"].empty());
}

TEST_F(ComparisonRoutesTest, AShareLinkSeesNeitherTheOtherScanNorThatItWasCompared) {
  ASSERT_EQ(post(server_->token()).status, 202);
  ASSERT_EQ(when_over()["state"], "ready");
  for (const std::string& shared : {first_, second_}) {
    const std::string link =
        ask("POST", "scans/" + shared + "/shares", server_->token(), "{}").json()["secret"];
    for (const std::string& path : {comparisons(), comparison(), points()}) {
      const Answer refused = ask("GET", path, link);
      EXPECT_EQ(refused.status, shared == first_ ? 403 : 404) << path;
      if (shared == first_) {
        EXPECT_THAT(refused.body, testing::Not(HasSubstr(second_))) << path;
      }
    }
    EXPECT_EQ(post(link).status, 403);
    EXPECT_EQ(ask("DELETE", comparison(), link).status, 403);
    EXPECT_EQ(ask("GET", "scans/" + first_ + "/exports/comparison_" + second_, link).status, 404);
    EXPECT_THAT(ask("GET", "scans/" + shared + "/exports", link).body,
                testing::Not(HasSubstr("comparison")));
  }
}

TEST_F(ComparisonRoutesTest, ATokenThatViewsLooksAndOneThatScansToo) {
  const std::string view = make_token(R"(["view"])"), both = make_token(R"(["view", "scan"])");
  EXPECT_EQ(post(view).status, 403);
  EXPECT_EQ(post(both).status, 202);
  EXPECT_EQ(when_over()["state"], "ready");
  EXPECT_EQ(ask("GET", comparison(), view).status, 200);
  EXPECT_EQ(ask("DELETE", comparison(), view).status, 403);
}

TEST_F(ComparisonRoutesTest, DeletingEitherScanEndsIt) {
  ASSERT_EQ(post(server_->token()).status, 202);
  ASSERT_EQ(when_over()["state"], "ready");
  ASSERT_EQ(ask("DELETE", "scans/" + second_, server_->token()).status, 200);
  EXPECT_EQ(ask("GET", comparison(), server_->token()).status, 404);
  EXPECT_EQ(ask("GET", points(), server_->token()).status, 404);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data/scans/" + first_ + "/comparison_" + second_ +
                                       ".json"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data/scans/" + first_ + "/comparison_" + second_ +
                                       ".ply"));
}

TEST_F(ComparisonRoutesTest, WhatIsWrongIsSaid) {
  const std::string& token = server_->token();
  for (const char* body :
       {"{}", "[]", "{\"with\": 1}", "{\"with\": \"../x\"}", "{\"with\": \"x\", \"y\": 1}"}) {
    const Answer wrong = ask("POST", comparisons(), token, body);
    EXPECT_EQ(wrong.status, 400) << body;
    EXPECT_THAT(wrong.body, HasSubstr("the id of another scan")) << body;
  }
  const Answer itself = ask("POST", comparisons(), token, Json{{"with", first_}}.dump());
  EXPECT_EQ(itself.status, 400);
  EXPECT_THAT(itself.body, HasSubstr("not with itself"));
  EXPECT_EQ(ask("POST", comparisons(), token, Json{{"with", new_scan_id()}}.dump()).status, 404);
  EXPECT_EQ(ask("GET", comparisons() + "/x", token).status, 404);
  EXPECT_EQ(ask("GET", "scans/" + new_scan_id() + "/comparisons", token).status, 404);
}

}  // namespace
}  // namespace hermite::server
