// Measuring over HTTP, of a real server. What comes of points is in tests/core/measure.
#include "server/routes/measure_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/output/ply.h"
#include "server/store/scan_id.h"
#include "tests/support/route_test.h"
#include "tests/support/two_walls.h"

namespace hermite::server {
namespace measure_routes_test {

using Json = nlohmann::json;
using testing::HasSubstr;

class MeasureRoutesTest : public test::RouteTest {
 protected:
  MeasureRoutesTest() {
    add_scans({test::finished_row(id_), test::finished_row(imported_id_)});
    put(id_, "surfels.ply", output::format_ply(test::two_walls()));
    put(id_, "trajectory.txt", "0.0 0 0 0 0 0 0 1\n");
    put(id_, "report.json", "{}");
    put(imported_id_, "cloud.ply", output::format_ply(test::two_walls()));
  }
  using Answer = test::RouteAnswer;
  Answer ask(const std::string& method, const std::string& path, const std::string& body = "",
             const std::string& token = "") {
    return RouteTest::ask(method, "/api/v1/scans/" + path, token.empty() ? server_->token() : token,
                          body);
  }

  const std::string id_ = new_scan_id(), imported_id_ = new_scan_id();
};

const std::string kTwoPoints = R"("points": [[0, 0, 1], [0, 0, 2.5]]})";
const std::string kDistance = R"("kind": "distance", )" + kTwoPoints;

TEST_F(MeasureRoutesTest, ADistanceIsMeasuredKeptTakenAndRemoved) {
  start();
  const Answer measured = ask("POST", id_ + "/measure",
                              R"({"kind": "distance", "points": [[0, 0, 1.003], [0, 0, 2.499]]})");
  ASSERT_EQ(measured.status, 200) << measured.body;
  EXPECT_NEAR(measured.json()["value"].get<double>(), 1.5, 1e-4);
  EXPECT_THAT(measured.body, HasSubstr("1.500 m ± 0.00"));
  EXPECT_EQ(ask("GET", id_ + "/measurements").json()["measurements"].size(), 0u)
      << "it was not kept";

  const Answer kept = ask("POST", id_ + "/measurements", R"({"name": "=a \"door\"", )" + kDistance);
  ASSERT_EQ(kept.status, 201) << kept.body;
  const Json list = ask("GET", id_ + "/measurements").json()["measurements"];
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0], kept.json());
  EXPECT_EQ(list[0]["name"], "=a \"door\"");
  for (const char* same : {"kind", "unit", "confidence", "words"})
    EXPECT_EQ(list[0][same], measured.json()[same]) << same;
  const Answer csv = ask("GET", id_ + "/measurements.csv");
  EXPECT_THAT(csv.header, HasSubstr("text/csv"));
  EXPECT_THAT(csv.body, HasSubstr("name,kind,value,unit,half_width_95,points_m\r\n"));
  EXPECT_THAT(csv.body, HasSubstr("\r\n\"'=a \"\"door\"\"\",distance,1.5000,m,0.00"));
  EXPECT_THAT(csv.body, HasSubstr(",0.0000 0.0000 1.0000; 0.0000 0.0000 2.5000\r\n"));

  const std::string one = id_ + "/measurements/" + list[0]["id"].get<std::string>();
  EXPECT_EQ(ask("DELETE", one).status, 200);
  EXPECT_EQ(ask("DELETE", one).status, 404);
  EXPECT_EQ(ask("GET", id_ + "/measurements").json()["measurements"].size(), 0u);
}

TEST_F(MeasureRoutesTest, OtherKindsAreKeptWithWhatTheyNeed) {
  start();
  const auto kept = [&](const std::string& body) {
    const Answer answer = ask("POST", id_ + "/measurements", R"({"name": "a", )" + body);
    EXPECT_EQ(answer.status, 201) << answer.body;
    return answer.json();
  };
  EXPECT_NEAR(kept(R"("kind": "plane", )" + kTwoPoints)["value"].get<double>(), 1.5, 1e-3);
  const Json height =
      kept(R"("kind": "height", "up": [0, -1, 0], "points": [[0, 0.05, 1], [0, -0.05, 2.5]]})");
  EXPECT_NEAR(height["value"].get<double>(), 0.1, 1e-5);
  EXPECT_EQ(height["up"], Json({0.0, -1.0, 0.0}));
  EXPECT_EQ(kept(R"("kind": "angle", )" + kTwoPoints)["unit"], "deg");
  const Json area =
      kept(R"("kind": "area", "points": [[-0.1, -0.1, 1], [0.1, -0.1, 1], [0.1, 0.1, 1]]})");
  EXPECT_NEAR(area["value"].get<double>(), 0.02, 1e-5);
  EXPECT_EQ(area["normals"].size(), 3u);
  EXPECT_THAT(area["words"].get<std::string>(), HasSubstr("0.020 m² ± 0.00"));
  const Json list = ask("GET", id_ + "/measurements").json()["measurements"];
  ASSERT_EQ(list.size(), 4u);
  EXPECT_THAT(ask("GET", id_ + "/measurements.csv").body, HasSubstr(R"("a",area,0.0200,m2,)"));
}

TEST_F(MeasureRoutesTest, WhatCannotBeMeasuredIsSaidInAMessage) {
  put(id_, "surfels.ply", output::format_ply(test::two_walls()).substr(0, 9000));
  start();
  const auto message_of = [&](const std::string& body) {
    const Answer answer = ask("POST", id_ + "/measure", body);
    EXPECT_EQ(answer.status, 400) << body;
    return answer.message();
  };
  EXPECT_THAT(message_of("nonsense"), HasSubstr("JSON object"));
  EXPECT_THAT(message_of("{}"),
              HasSubstr("kind must be one of distance, plane, height, angle, area"));
  EXPECT_THAT(message_of(R"({"kind": "weight", )" + kTwoPoints), HasSubstr("kind must be one of"));
  EXPECT_THAT(message_of(R"({"kind": "distance"})"),
              HasSubstr("points must be a list of at most 64"));
  EXPECT_THAT(message_of(R"({"kind": "distance", "points": [[0, 0], [0, 0, 1]]})"),
              HasSubstr("points[0] must be three numbers"));
  EXPECT_THAT(message_of(R"({"kind": "distance", "points": [[0, 0, 1], [0, 0, "1"]]})"),
              HasSubstr("points[1] must be three numbers"));
  EXPECT_THAT(message_of(R"({"kind": "distance", "points": [[0, 0, 1]]})"),
              HasSubstr("points has 1 points"));
  EXPECT_THAT(message_of(R"({"kind": "distance", "points": [[0, 0, 1], [0, 0, 1e999]]})"),
              HasSubstr("JSON"));
  EXPECT_THAT(message_of(R"({"and": 1, )" + kDistance), HasSubstr("nothing else"));
  EXPECT_THAT(message_of(R"({"kind": "height", "up": [0, -3, 0], )" + kTwoPoints),
              HasSubstr("its length is 3, allowed are 0.99 to 1.01"));
  EXPECT_THAT(message_of(R"({"kind": "height", "up": "up", )" + kTwoPoints),
              HasSubstr("up must be three numbers"));
  EXPECT_THAT(message_of(R"({"up": [0, -1, 0], )" + kDistance),
              HasSubstr("up belongs to kind height"));
  EXPECT_EQ(ask("POST", id_ + "/measure").status, 400);
  EXPECT_EQ(ask("POST", id_ + "/measure", std::string(9000, ' ')).status, 413);
  EXPECT_EQ(ask("POST", id_ + "/measure", "{" + kDistance).status, 500) << "the file is cut";
  EXPECT_EQ(ask("POST", new_scan_id() + "/measure", "{" + kDistance).status, 404);
  const Answer imported = ask("POST", imported_id_ + "/measure", "{" + kDistance);
  EXPECT_EQ(imported.status, 409);
  EXPECT_THAT(imported.message(), HasSubstr("has no trajectory.txt"));
  const std::string long_name(201, 'n');
  EXPECT_THAT(ask("POST", id_ + "/measurements", R"({"name": ")" + long_name + R"(", )" + kDistance)
                  .message(),
              HasSubstr("name has 201 bytes"));
}

TEST_F(MeasureRoutesTest, AShareLinkMeasuresAndKeepsNothing) {
  start();
  const std::string share = ask("POST", id_ + "/shares").json()["secret"];
  EXPECT_EQ(ask("POST", id_ + "/measure", "{" + kDistance, share).status, 200);
  EXPECT_EQ(ask("POST", id_ + "/measurements", R"({"name": "a", )" + kDistance, share).status, 403);
  EXPECT_EQ(ask("GET", id_ + "/measurements", "", share).status, 200);
  EXPECT_EQ(ask("POST", imported_id_ + "/measure", "{" + kDistance, share).status, 404);
}

TEST_F(MeasureRoutesTest, AScanThatIsDeletedIsNotMeasuredInAnyMore) {
  start();
  EXPECT_EQ(ask("POST", id_ + "/measure", "{" + kDistance).status, 200);
  EXPECT_EQ(ask("POST", id_ + "/measure", "{" + kDistance).status, 200)
      << "of what is kept in memory";
  EXPECT_EQ(ask("DELETE", id_).status, 200);
  EXPECT_EQ(ask("POST", id_ + "/measure", "{" + kDistance).status, 404);
}

}  // namespace measure_routes_test
}  // namespace hermite::server
