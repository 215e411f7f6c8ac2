// Edits over HTTP, of a real server. What they do to meshes and clouds: tests/core/edit and
// tests/server/exports.
#include "server/routes/edit_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "server/store/scan_id.h"
#include "tests/support/plane_cloud.h"
#include "tests/support/route_test.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class EditRoutesTest : public test::RouteTest {
 protected:
  EditRoutesTest() {
    ScanRow finished = test::finished_row(scan_), running = test::finished_row(running_);
    running.phase = ScanPhase::kRunning;
    add_scans({finished, running});
    put(scan_, "cloud.ply", output::format_ply(test::plane_cloud(30)));
    start();
  }
  using Answer = test::RouteAnswer;
  Answer ask(const std::string& method, const std::string& path, const std::string& token,
             const std::string& body = "") const {
    return RouteTest::ask(method, "/api/v1/scans/" + path, token, body);
  }
  Answer change(const Json& body, const std::string& token) {
    return ask("PUT", scan_ + "/edits", token, body.dump());
  }
  Json edits(const std::string& token) { return ask("GET", scan_ + "/edits", token).json(); }
  // The number of points that are left, once the server has made their file.
  std::size_t exported_count() {
    const std::string path = scan_ + "/exports";
    EXPECT_LT(ask("POST", path, server_->token(), R"({"format": "points-ply"})").status, 300);
    for (int i = 0; i < 6000; ++i) {
      const Answer ply = ask("GET", path + "/points-ply", server_->token());
      if (ply.status == 200) return output::parse_ply(ply.body)->positions.size();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return 0;
  }

  const std::string scan_ = new_scan_id(), running_ = new_scan_id();
};

Json box_edit(const char* kind, double low_x_m) {
  return {{"kind", kind},
          {"box",
           {{"axes", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
            {"low_m", {low_x_m, -9, -9}},
            {"high_m", {9, 9, 9}}}}};
}

Json list_of(std::int64_t version, const Json::array_t& edits) {
  return {{"version", version}, {"edits", edits}};
}

TEST_F(EditRoutesTest, WhatIsTakenOutIsMissingInExportsUntilItIsTakenBack) {
  const std::string& token = server_->token();
  EXPECT_EQ(edits(token), list_of(0, {}));
  const std::size_t all = exported_count();
  EXPECT_EQ(all, 900u);
  const Answer changed = change(list_of(0, {box_edit("remove_inside", 0.145)}), token);
  ASSERT_EQ(changed.status, 200) << changed.body;
  EXPECT_EQ(changed.json()["version"], 1);
  EXPECT_EQ(edits(token)["edits"].size(), 1u);
  const std::size_t removed = exported_count();
  EXPECT_EQ(removed, 450u);
  ASSERT_EQ(change(list_of(1, {box_edit("keep_inside", 0.145)}), token).json()["version"], 2);
  EXPECT_EQ(exported_count() + removed, all);
  ASSERT_EQ(change(list_of(2, {}), token).status, 200);
  EXPECT_EQ(exported_count(), all);
  EXPECT_EQ(output::parse_ply(ask("GET", scan_ + "/cloud.ply", token).body)->positions.size(), all)
      << "results never change";
}

TEST_F(EditRoutesTest, WhoComesSecondIsToldWhatThereIs) {
  const std::string& token = server_->token();
  ASSERT_EQ(change(list_of(0, {box_edit("remove_inside", 0.145)}), token).status, 200);
  const Answer late = change(list_of(0, {box_edit("remove_inside", 0.2)}), token);
  EXPECT_EQ(late.status, 409);
  EXPECT_THAT(late.body, HasSubstr("have version 1 by now"));
  EXPECT_EQ(late.json()["edits"], edits(token));
  EXPECT_EQ(edits(token)["edits"][0]["box"]["low_m"][0], 0.145);
  EXPECT_EQ(change(list_of(0, {box_edit("remove_inside", 0.145)}), token).json()["version"], 1)
      << "the same request once more";
}

TEST_F(EditRoutesTest, OnlyWhoMadeTheScanEditsIt) {
  const Json list = list_of(0, {box_edit("remove_inside", 0.145)});
  const std::string link = ask("POST", scan_ + "/shares", server_->token(), "{}").json()["secret"];
  EXPECT_EQ(edits(link)["version"], 0);
  EXPECT_EQ(change(list, link).status, 403);
  EXPECT_EQ(change(list, make_token(R"(["view"])")).status, 403);
  EXPECT_EQ(change(list, make_token(R"(["view", "scan"])")).status, 403) << "it is another token's";
  EXPECT_EQ(edits(server_->token())["version"], 0);
}

TEST_F(EditRoutesTest, WhatIsWrongIsSaid) {
  const std::string& token = server_->token();
  const Answer wrong = change(list_of(0, {{{"kind", "melt"}, {"box", 1}}}), token);
  EXPECT_EQ(wrong.status, 400);
  EXPECT_THAT(wrong.body, HasSubstr("edits[0].kind must be"));
  EXPECT_EQ(ask("PUT", scan_ + "/edits", token).status, 400);
  EXPECT_EQ(ask("PUT", scan_ + "/edits", token, std::string(20'000, ' ')).status, 413);
  EXPECT_EQ(ask("GET", new_scan_id() + "/edits", token).status, 404);
  EXPECT_EQ(ask("PUT", new_scan_id() + "/edits", token, list_of(0, {}).dump()).status, 404);
  const Answer nothing = change(list_of(0, {box_edit("remove_inside", -9)}), token);
  EXPECT_EQ(nothing.status, 200) << "it can be taken back";
}

TEST_F(EditRoutesTest, DamagedEditsAreSaidAndNotOverwritten) {
  put(scan_, "edits.json", "{\"version\": 2");
  const Answer shown = ask("GET", scan_ + "/edits", server_->token());
  EXPECT_EQ(shown.status, 500);
  EXPECT_THAT(shown.body, HasSubstr("edits.json: "));
  EXPECT_EQ(change(list_of(0, {box_edit("remove_inside", 0.145)}), server_->token()).status, 500);
}

}  // namespace
}  // namespace hermite::server
