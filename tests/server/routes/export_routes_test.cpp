// Exports over HTTP, of a real server: what there is, asking for one, taking it. What becomes of
// them otherwise: tests/server/exports.
#include "server/routes/export_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/output/ply.h"
#include "core/output/ply_reader.h"
#include "server/exports/exports.h"
#include "server/store/scan_id.h"
#include "tests/support/plane_cloud.h"
#include "tests/support/route_test.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class ExportRoutesTest : public test::RouteTest {
 protected:
  ExportRoutesTest() {
    ScanRow row = test::finished_row(id_);
    row.finished_at_ms = 1'700'000'000'000;
    add_scans({row});
    put(id_, "cloud.ply", output::format_ply(test::plane_cloud(30)));
    start();
  }
  using Answer = test::RouteAnswer;
  Answer post(const std::string& format, const std::string& token) {
    return ask("POST", exports(), token, Json{{"format", format}}.dump());
  }
  std::string exports() const { return "/api/v1/scans/" + id_ + "/exports"; }
  // Of the list, when it is neither queued nor running any more.
  std::string state_at_the_end(const std::string& format) {
    for (int i = 0; i < 3000; ++i) {
      const Json list = ask("GET", exports(), server_->token()).json();
      for (const Json& one : list["exports"])
        if (one["format"] == format && one["state"] != "queued" && one["state"] != "running")
          return one["state"];
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return "never";
  }

  const std::string id_ = new_scan_id();
};

TEST_F(ExportRoutesTest, AMeshIsAskedForAndTakenAlsoInPartsAndAfterARestart) {
  const std::string path = exports() + "/ply";
  const Answer none = ask("GET", path, server_->token());
  EXPECT_EQ(none.status, 404);
  EXPECT_THAT(none.body, HasSubstr("has no mesh.ply: it is missing"));
  const Answer asked = post("ply", server_->token());
  EXPECT_EQ(asked.status, 202) << asked.body;
  EXPECT_EQ(asked.json()["format"], "ply");
  ASSERT_EQ(state_at_the_end("ply"), "ready");
  EXPECT_EQ(post("ply", server_->token()).status, 200);

  const Answer file = ask("GET", path, server_->token());
  EXPECT_EQ(file.status, 200);
  EXPECT_THAT(file.header, HasSubstr("attachment; filename=\"" + id_ + "-mesh.ply\""));
  EXPECT_GT(output::parse_ply(file.body)->triangles.size(), 100u);
  const Answer part = ask("GET", path, server_->token(), "", "Range: bytes=3-9\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, file.body.substr(3, 7));
  start();
  EXPECT_EQ(ask("GET", path, server_->token()).body, file.body);
}

TEST_F(ExportRoutesTest, WhatIsWrongIsNamed) {
  const std::string token = server_->token();
  for (const char* body :
       {"", "{}", "[]", "glb", R"({"format": 3})", R"({"format": "glb", "size": 3})"})
    EXPECT_EQ(ask("POST", exports(), token, body).status, 400) << body;
  EXPECT_EQ(post("fbx", token).status, 400);
  EXPECT_THAT(post("fbx", token).body, HasSubstr("known are "));
  EXPECT_EQ(ask("GET", exports() + "/fbx", token).status, 404);
  EXPECT_EQ(ask("GET", exports() + "/", token).status, 404);
  EXPECT_EQ(ask("GET", exports() + "/a/b", token).status, 404);
  EXPECT_EQ(ask("GET", "/api/v1/scans/" + new_scan_id() + "/exports", token).status, 404);
  EXPECT_EQ(ask("POST", "/api/v1/scans/nobody/exports", token, R"({"format": "glb"})").status, 404);
  EXPECT_EQ(ask("DELETE", exports() + "/cloud", token).status, 400)
      << "a result goes with its scan";
}

TEST_F(ExportRoutesTest, AMeshIsFinishedByOptionsWhoseLimitsAreNamed) {
  const std::string token = server_->token();
  const Answer asked =
      ask("POST", exports(), token,
          R"({"format": "ply", "simplify_um": 1000, "fill_holes_mm": 50, "close": true})");
  EXPECT_EQ(asked.status, 202) << asked.body;
  EXPECT_EQ(asked.json()["format"], "ply_s1000_f50_c");
  EXPECT_EQ(asked.json()["of_format"], "ply");
  EXPECT_EQ(asked.json()["file"], "mesh_s1000_f50_c.ply");
  EXPECT_EQ(asked.json()["close"], true);
  ASSERT_EQ(state_at_the_end("ply_s1000_f50_c"), "ready");
  EXPECT_THAT(ask("GET", exports() + "/ply_s1000_f50_c", token).body,
              HasSubstr("property uchar filled"));
  EXPECT_EQ(ask("DELETE", exports() + "/ply_s1000_f50_c", token).status, 200);
  for (const char* body :
       {R"({"format": "ply", "simplify_um": 1.5})", R"({"format": "ply", "close": 1})",
        R"({"format": "ply", "triangles": "5"})", R"({"format": "ply", "simplify_um": -3})",
        R"({"format": "ply", "triangles": 5})", R"({"format": "las", "close": true})",
        R"({"format": "ply", "fill_holes_mm": 18446744073709551615})", R"({"format": "glb_x"})"})
    EXPECT_EQ(ask("POST", exports(), token, body).status, 400) << body;
  EXPECT_THAT(ask("POST", exports(), token, R"({"format": "ply", "fill_holes_mm": 10001})").body,
              HasSubstr("expected 0 to 10000"));
}

TEST_F(ExportRoutesTest, AShareLinkTakesWhatThereIsAndAsksForTheMeshAlone) {
  const std::string secret =
      ask("POST", "/api/v1/scans/" + id_ + "/shares", server_->token()).json()["secret"];
  EXPECT_EQ(ask("GET", exports(), secret).status, 200);
  const Answer refused = post("ply", secret);
  EXPECT_EQ(refused.status, 403);
  EXPECT_THAT(refused.body, HasSubstr("a share link may ask for"));
  EXPECT_EQ(post(std::string(kViewerMesh), secret).status, 202);
  ASSERT_EQ(state_at_the_end(std::string(kViewerMesh)), "ready");
  EXPECT_EQ(ask("GET", exports() + "/" + std::string(kViewerMesh), secret).status, 200);
  EXPECT_EQ(ask("DELETE", exports() + "/" + std::string(kViewerMesh), secret).status, 403);
  post("ply", make_token(R"(["view"])"));
  ASSERT_EQ(state_at_the_end("ply"), "ready");
  EXPECT_EQ(ask("GET", exports() + "/ply", secret).status, 200) << "somebody else has asked for it";
}

TEST_F(ExportRoutesTest, OneIsRemovedAndAllGoWithTheScan) {
  for (const char* format : {"ply", "glb"}) {
    post(format, server_->token());
    ASSERT_EQ(state_at_the_end(format), "ready");
  }
  EXPECT_EQ(ask("DELETE", exports() + "/glb", server_->token()).status, 200);
  EXPECT_EQ(ask("GET", exports() + "/glb", server_->token()).status, 404);
  EXPECT_EQ(ask("DELETE", exports() + "/glb", server_->token()).status, 404);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "data/scans/" + id_ + "/mesh.ply"));
  EXPECT_EQ(ask("DELETE", "/api/v1/scans/" + id_, server_->token()).status, 200);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data/scans/" + id_));
  EXPECT_EQ(ask("GET", exports(), server_->token()).status, 404);
}

}  // namespace
}  // namespace hermite::server
