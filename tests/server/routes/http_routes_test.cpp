// Who may do what over HTTP, on a real server. How a request is read is in
// http_connection_test.cpp.
#include "server/routes/http_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "server/store/scan_id.h"
#include "tests/source_root/source_root.h"
#include "tests/support/openapi_document.h"
#include "tests/support/route_test.h"

namespace hermite::server {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class HttpRoutesTest : public test::RouteTest {
 protected:
  HttpRoutesTest() {
    add_scans({test::finished_row(id_), test::finished_row(other_id_)});
    for (const std::string& id : {id_, other_id_}) put(id, "cloud.ply", "ply points");
    start();
  }
  using Answer = test::RouteAnswer;
  int status(const std::string& method, const std::string& path, const std::string& token) {
    return ask(method, path, token).status;
  }
  Json make_share() {
    return ask("POST", "/api/v1/scans/" + id_ + "/shares", server_->token()).json();
  }

  const std::string id_ = new_scan_id(), other_id_ = new_scan_id();
};

// What a route answers to tokens of different scopes.
struct ScopeCase {
  const char* method;
  std::string path;
  int with_view, with_scan, with_both;
};
std::vector<ScopeCase> scope_cases(const std::string& id) {
  return {
      {"GET", "/api/v1/scans", 200, 403, 200},
      {"GET", "/api/v1/scans/" + id, 200, 403, 200},
      {"GET", "/api/v1/scans/" + id + "/cloud.ply", 200, 403, 200},
      {"GET", "/api/v1/access", 200, 200, 200},
      {"PATCH", "/api/v1/scans/" + id, 403, 403, 403},
      {"POST", "/api/v1/scans/" + id + "/stop", 403, 403, 403},
      {"POST", "/api/v1/scans/" + id + "/pause", 403, 403, 403},
      {"POST", "/api/v1/scans/" + id + "/unpause", 403, 403, 403},
      {"DELETE", "/api/v1/scans/" + id, 403, 403, 403},
      {"GET", "/api/v1/scans/" + id + "/exports", 200, 403, 200},
      {"POST", "/api/v1/scans/" + id + "/exports", 400, 403, 400},
      {"GET", "/api/v1/scans/" + id + "/exports/glb", 404, 403, 404},
      {"DELETE", "/api/v1/scans/" + id + "/exports/glb", 403, 403, 404},
      {"GET", "/api/v1/scans/" + id + "/comparisons", 200, 403, 200},
      {"POST", "/api/v1/scans/" + id + "/comparisons", 403, 403, 400},
      {"GET", "/api/v1/scans/" + id + "/comparisons/x", 404, 403, 404},
      {"GET", "/api/v1/scans/" + id + "/compared-points/x", 404, 403, 404},
      {"DELETE", "/api/v1/scans/" + id + "/comparisons/x", 403, 403, 404},
      {"POST", "/api/v1/scans/" + id + "/measure", 400, 403, 400},
      {"GET", "/api/v1/scans/" + id + "/measurements", 200, 403, 200},
      {"GET", "/api/v1/scans/" + id + "/measurements.csv", 200, 403, 200},
      {"POST", "/api/v1/scans/" + id + "/measurements", 403, 403, 403},
      {"DELETE", "/api/v1/scans/" + id + "/measurements/x", 403, 403, 403},
      {"GET", "/api/v1/scans/" + id + "/notes", 200, 403, 200},
      {"POST", "/api/v1/scans/" + id + "/notes", 403, 403, 403},
      {"PATCH", "/api/v1/scans/" + id + "/notes/x", 403, 403, 403},
      {"DELETE", "/api/v1/scans/" + id + "/notes/x", 403, 403, 403},
      {"GET", "/api/v1/scans/" + id + "/frames", 410, 403, 410},
      {"GET", "/api/v1/scans/" + id + "/frames/color/0", 410, 403, 410},
      {"GET", "/api/v1/scans/" + id + "/frames/depth/0", 410, 403, 410},
      {"GET", "/api/v1/scans/" + id + "/frames/depth16/0", 410, 403, 410},
      {"GET", "/api/v1/scans/" + id + "/shares", 403, 403, 200},
      {"POST", "/api/v1/scans/" + id + "/shares", 403, 403, 201},
      {"GET", "/api/v1/shares", 403, 403, 200},
      {"DELETE", "/api/v1/shares/x", 403, 403, 404},
      {"GET", "/api/v1/tokens", 403, 403, 403},
      {"POST", "/api/v1/tokens", 403, 403, 403},
      {"DELETE", "/api/v1/tokens/first", 403, 403, 403},
      {"GET", "/api/v1/uploads", 403, 200, 200},
      {"POST", "/api/v1/uploads", 403, 412, 412},
      {"HEAD", "/api/v1/uploads/x", 403, 412, 412},
      {"PATCH", "/api/v1/uploads/x", 403, 412, 412},
      {"PUT", "/api/v1/uploads/x", 403, 411, 411},
      {"DELETE", "/api/v1/uploads/x", 403, 412, 412},
      {"GET", "/api/v1/jobs", 403, 200, 200},
      {"POST", "/api/v1/jobs", 403, 403, 400},
      {"GET", "/api/v1/jobs/x", 403, 404, 404},
      {"DELETE", "/api/v1/jobs/x", 403, 404, 404},
      {"POST", "/api/v1/jobs/x/retry", 403, 404, 404},
  };
}

TEST_F(HttpRoutesTest, EveryRouteAsksForItsScope) {
  const std::string view = make_token(R"(["view"])"), scan = make_token(R"(["scan"])"),
                    both = make_token(R"(["view", "scan"])");
  for (const ScopeCase& route : scope_cases(id_)) {
    EXPECT_EQ(status(route.method, route.path, view), route.with_view)
        << route.method << " " << route.path;
    EXPECT_EQ(status(route.method, route.path, scan), route.with_scan)
        << route.method << " " << route.path;
    EXPECT_EQ(status(route.method, route.path, both), route.with_both)
        << route.method << " " << route.path;
  }
  EXPECT_THAT(ask("DELETE", "/api/v1/scans/" + id_, both).body,
              HasSubstr("this token allows view, scan; admin is needed"));
  EXPECT_EQ(status("DELETE", "/api/v1/scans/" + id_, server_->token()), 200);
}

TEST_F(HttpRoutesTest, TheReadmeHasEveryRouteAndNoOther) {
  std::ifstream readme(test::source_root() / "server/README.md");
  std::vector<std::string> written;
  for (std::string line; std::getline(readme, line);) {
    const std::size_t end = line.find("` |");
    if (line.starts_with("| `") && line.find(" /api/") != std::string::npos)
      written.push_back(line.substr(3, end - 3));
  }
  EXPECT_THAT(written, testing::UnorderedElementsAreArray(api_routes()));
}

TEST_F(HttpRoutesTest, TheOpenApiDocumentHasEveryRouteAndNoOther) {
  const std::map<std::string, Json> described =
      test::described_operations(test::openapi_document());
  const std::vector<std::string> list = api_routes();
  const std::set<std::string> there(list.begin(), list.end());
  for (const std::string& route : there)
    EXPECT_TRUE(described.contains(route)) << test::kOpenApiFile << " does not describe " << route;
  for (const auto& [route, operation] : described) {
    if (route.find(" /api/") == std::string::npos) continue;  // admin_test.cpp has these
    EXPECT_TRUE(there.contains(route))
        << test::kOpenApiFile << " describes " << route << ", which the server does not have";
  }
}

TEST_F(HttpRoutesTest, TheOpenApiDocumentHasTheScopesOfEveryRoute) {
  const std::string view = make_token(R"(["view"])"), scan = make_token(R"(["scan"])"),
                    both = make_token(R"(["view", "scan"])");
  for (const auto& [route, operation] : test::described_operations(test::openapi_document())) {
    if (route.find(" /api/") == std::string::npos) continue;
    const std::size_t space = route.find(' ');
    // Nothing has the id x, so only the scopes of a token can be a reason for 403.
    const std::string path =
        std::regex_replace(route.substr(space + 1), std::regex("\\{[a-z]+\\}"), "x");
    const std::string method = route.substr(0, space);
    const auto is_refused = [&](const std::string& token) {
      return status(method, path, token) == 403;
    };
    Json needed = Json::array();
    if (is_refused(both)) {
      needed.push_back("admin");
    } else {
      if (is_refused(scan)) needed.push_back("view");
      if (is_refused(view)) needed.push_back("scan");
    }
    EXPECT_EQ(operation.value("x-scope", Json()), needed)
        << "x-scope of " << route << " in " << test::kOpenApiFile;
  }
}

TEST_F(HttpRoutesTest, EveryWrittenRouteIsThere) {
  // Whoever is not let in learns nothing about routes: a token is needed to see that one is
  // missing.
  for (const std::string& route : api_routes()) {
    const std::size_t space = route.find(' ');
    std::string path = route.substr(space + 1);
    if (const std::size_t at = path.find("{id}"); at != std::string::npos) path.replace(at, 4, "x");
    const Answer answer = ask(route.substr(0, space), path, server_->token());
    EXPECT_NE(answer.status, 405) << route;
    EXPECT_THAT(answer.body, Not(HasSubstr("there is nothing at this path"))) << route;
  }
}

TEST_F(HttpRoutesTest, AShareLinkSeesItsScanAndNothingElse) {
  const std::string secret = make_share()["secret"];
  const Json list = ask("GET", "/api/v1/scans", secret).json()["scans"];
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["id"], id_);
  EXPECT_EQ(status("GET", "/api/v1/scans/" + id_, secret), 200);
  EXPECT_EQ(status("GET", "/api/v1/scans/" + id_ + "/cloud.ply", secret), 200);
  const Answer other = ask("GET", "/api/v1/scans/" + other_id_, secret),
               none = ask("GET", "/api/v1/scans/" + new_scan_id(), secret);
  EXPECT_EQ(other.status, 404) << "not 403: it may not know that there is one";
  EXPECT_EQ(none.status, 404);
  EXPECT_EQ(status("GET", "/api/v1/scans/" + other_id_ + "/cloud.ply", secret), 404);
  for (const char* method : {"DELETE", "POST"})
    EXPECT_NE(status(method, "/api/v1/scans/" + id_ + (method[0] == 'P' ? "/shares" : ""), secret),
              200)
        << method;
  EXPECT_EQ(status("GET", "/api/v1/shares", secret), 403);
  EXPECT_EQ(status("GET", "/api/v1/tokens", secret), 403);
  EXPECT_EQ(status("GET", "/api/v1/jobs", secret), 403);
  EXPECT_EQ(status("GET", "/api/v1/uploads", secret), 403);
}

TEST_F(HttpRoutesTest, ARevokedShareLinkOpensNothing) {
  const Json share = make_share();
  const std::string path = "/api/v1/shares/" + share["share"]["id"].get<std::string>();
  EXPECT_EQ(status("DELETE", "/api/v1/tokens/" + share["share"]["id"].get<std::string>(),
                   server_->token()),
            404);
  EXPECT_EQ(status("DELETE", path, server_->token()), 200);
  EXPECT_EQ(status("GET", "/api/v1/scans/" + id_, share["secret"]), 401);
  EXPECT_EQ(ask("GET", "/api/v1/shares", server_->token()).json()["shares"][0]["state"], "revoked");
}

TEST_F(HttpRoutesTest, AShareLinkGoesWithItsScan) {
  const std::string secret = make_share()["secret"];
  ASSERT_EQ(status("DELETE", "/api/v1/scans/" + id_, server_->token()), 200);
  EXPECT_EQ(status("GET", "/api/v1/scans", secret), 401);
}

TEST_F(HttpRoutesTest, ATokenWorksUntilItIsRevoked) {
  const Answer made = ask("POST", "/api/v1/tokens", server_->token(),
                          R"({"name": "lab", "scopes": ["view"], "days": 1})");
  EXPECT_EQ(made.status, 201);
  const std::string secret = made.json()["secret"], id = made.json()["token"]["id"];
  EXPECT_EQ(status("GET", "/api/v1/scans", secret), 200);
  const std::string list = ask("GET", "/api/v1/tokens", server_->token()).body;
  EXPECT_THAT(list, HasSubstr("\"name\":\"lab\""));
  EXPECT_THAT(list, Not(HasSubstr(secret)));
  EXPECT_THAT(list, Not(HasSubstr(server_->token())));
  EXPECT_EQ(status("DELETE", "/api/v1/tokens/" + id, server_->token()), 200);
  EXPECT_EQ(status("GET", "/api/v1/scans", secret), 401);
}

TEST_F(HttpRoutesTest, WhoAsksIsToldWhatTheyMayDo) {
  EXPECT_EQ(ask("GET", "/api/v1/access", server_->token()).json(),
            Json({{"scopes", {"view", "scan", "admin"}}, {"scan", nullptr}, {"embedding", false}}));
  EXPECT_EQ(ask("GET", "/api/v1/access", make_token(R"(["scan"])")).json()["scopes"],
            Json({"scan"}));
  EXPECT_EQ(ask("GET", "/api/v1/access", make_share()["secret"]).json(),
            Json({{"scopes", {"view"}}, {"scan", id_}, {"embedding", false}}));
  EXPECT_EQ(status("GET", "/api/v1/access", "wrong"), 401);
}

TEST_F(HttpRoutesTest, AScanGetsAnotherTitle) {
  const auto rename = [this](const std::string& body) {
    return ask("PATCH", "/api/v1/scans/" + id_, server_->token(), body);
  };
  EXPECT_EQ(rename(R"({"title": "K\u00fcche"})").status, 200);
  EXPECT_EQ(ask("GET", "/api/v1/scans/" + id_, server_->token()).json()["title"], "K\u00fcche");
  EXPECT_THAT(rename(R"({"title": ")" + std::string(201, 'a') + "\"}").body,
              HasSubstr("title has 201 bytes, allowed are 1 to 200"));
  for (const char* wrong : {"", "[]", R"({"title": ""})", R"({"title": 1})",
                            R"({"title": "a\u0007"})", R"({"title": "a", "state": "failed"})"})
    EXPECT_EQ(rename(wrong).status, 400) << wrong;
  EXPECT_EQ(rename(R"({"title": ")" + std::string(5000, 'a') + "\"}").status, 413);
  EXPECT_EQ(ask("DELETE", "/api/v1/scans/" + id_, server_->token(), "{}").status, 400)
      << "a body where none belongs";
  EXPECT_EQ(ask("GET", "/api/v1/scans/" + id_, server_->token()).json()["title"], "K\u00fcche");
}

TEST_F(HttpRoutesTest, AScanGetsTags) {
  const auto label = [this](const Json& body) {
    return ask("PATCH", "/api/v1/scans/" + id_, server_->token(), body.dump());
  };
  const auto why = [&label](const Json& tags) { return label({{"tags", tags}}).body; };
  const Json title = ask("GET", "/api/v1/scans/" + id_, server_->token()).json()["title"];
  EXPECT_EQ(label({{"tags", {"old", "House 9", "old", "K\u00fcche"}}}).json()["tags"],
            Json({"House 9", "K\u00fcche", "old"}));
  const Json list = ask("GET", "/api/v1/scans", server_->token()).json();
  for (const Json& row : list["scans"]) EXPECT_EQ(row["tags"].size(), row["id"] == id_ ? 3u : 0u);
  EXPECT_EQ(ask("GET", "/api/v1/scans/" + id_, server_->token()).json()["title"], title);
  EXPECT_THAT(why("old"), HasSubstr("tags is no list"));
  EXPECT_THAT(why({"a", 1}), HasSubstr("tags[1] is no text"));
  EXPECT_THAT(why({""}), HasSubstr("tags[0] has 0 bytes, allowed are 1 to 50"));
  EXPECT_THAT(why({std::string(51, 'a')}), HasSubstr("tags[0] has 51 bytes"));
  EXPECT_THAT(why({"a\nb"}), HasSubstr("tags[0] has a control character"));
  EXPECT_THAT(why({" a"}), HasSubstr("tags[0] begins or ends with a space"));
  Json many = Json::array();
  for (int i = 0; i < 21; ++i) many.push_back("tag " + std::to_string(i));
  EXPECT_THAT(why(many), HasSubstr("tags has 21 different ones, allowed are 20"));
  // What is wrong in one of them changes neither.
  EXPECT_EQ(label({{"title", "changed"}, {"tags", {""}}}).status, 400);
  EXPECT_EQ(ask("GET", "/api/v1/scans/" + id_, server_->token()).json()["title"], title);
  EXPECT_EQ(label({{"title", "both"}, {"tags", Json::array()}}).json()["tags"], Json::array());
  EXPECT_EQ(ask("PATCH", "/api/v1/scans/" + id_, make_share()["secret"], R"({"tags": []})").status,
            403);
}

TEST_F(HttpRoutesTest, AScanThatHasEndedCannotBeStopped) {
  const Answer answer = ask("POST", "/api/v1/scans/" + id_ + "/stop", server_->token());
  EXPECT_EQ(answer.status, 409);
  EXPECT_THAT(answer.body, HasSubstr("there is nothing to stop"));
  EXPECT_EQ(status("POST", "/api/v1/scans/" + new_scan_id() + "/stop", server_->token()), 404);
}

TEST_F(HttpRoutesTest, AScanThatHasEndedCannotBePaused) {
  for (const std::string wish : {"/pause", "/unpause"}) {
    const Answer answer = ask("POST", "/api/v1/scans/" + id_ + wish, server_->token());
    EXPECT_EQ(answer.status, 409);
    EXPECT_THAT(answer.body, HasSubstr("does not run"));
    EXPECT_EQ(status("POST", "/api/v1/scans/" + new_scan_id() + wish, server_->token()), 404);
  }
}

TEST_F(HttpRoutesTest, ABadRequestIsNamed) {
  const Answer answer = ask("POST", "/api/v1/tokens", server_->token(), R"({"days": -1})");
  EXPECT_EQ(answer.status, 400);
  EXPECT_THAT(answer.body, HasSubstr("0 to 3650"));
  EXPECT_EQ(ask("POST", "/api/v1/tokens", server_->token(), "garbage").status, 400);
  EXPECT_EQ(
      ask("POST", "/api/v1/scans/" + new_scan_id() + "/shares", server_->token(), "{}").status,
      404);
}

TEST_F(HttpRoutesTest, WrongTokensMustWaitButRightOnesNeedNot) {
  for (int i = 0; i < ServiceOptions().failures_per_minute; ++i)
    EXPECT_EQ(status("GET", "/api/v1/scans", "wrong"), 401);
  const Answer late = ask("GET", "/api/v1/scans", "wrong");
  EXPECT_EQ(late.status, 429);
  EXPECT_THAT(late.header, HasSubstr("Retry-After: 12\r\n"));
  EXPECT_EQ(status("GET", "/api/v1/scans", server_->token()), 200);
}

TEST_F(HttpRoutesTest, WhoDidWhatIsInTheAuditLog) {
  const std::string view = make_token(R"(["view"])");
  const Json made =
      ask("POST", "/api/v1/tokens", server_->token(), R"({"scopes": ["scan"]})").json();
  EXPECT_EQ(status("DELETE", "/api/v1/scans/" + id_, view), 403);
  EXPECT_EQ(status("GET", "/api/v1/scans/" + other_id_, make_share()["secret"]), 404);
  EXPECT_EQ(status("GET", "/api/v1/scans/" + id_ + "/cloud.ply", view), 200);
  EXPECT_EQ(status("GET", "/api/v1/scans", view), 200);
  EXPECT_EQ(status("DELETE", "/api/v1/scans/" + id_, server_->token()), 200);
  for (int i = 0; i < 20; ++i) status("GET", "/api/v1/scans", "wrong");
  server_.reset();
  std::vector<std::string> found;
  std::int64_t wrong = 0;
  const Result<AuditCheck> check =
      check_audit(folder_ / "data/audit", [&](const std::string& line) {
        const Json entry = Json::parse(line);
        if (entry["did"] == "wrong token") wrong += entry["count"].get<std::int64_t>();
        EXPECT_EQ(entry["address"], entry["did"] == "server start" ? "" : "127.0.0.1");
        found.push_back(entry["did"].get<std::string>() + " " + entry["to"].get<std::string>() +
                        " " + entry["outcome"].get<std::string>());
      });
  ASSERT_TRUE(check.ok());
  EXPECT_EQ(check->broken, "");
  EXPECT_EQ(wrong, 20) << "also of those that were told to wait";
  EXPECT_THAT(found, testing::IsSupersetOf(
                         {"POST tokens " + made["token"]["id"].get<std::string>() + " 201",
                          "DELETE scan " + id_ + " 403", "GET scan " + other_id_ + " 404",
                          "GET cloud.ply " + id_ + " 200", "DELETE scan " + id_ + " 200"}));
  EXPECT_THAT(found, Not(testing::Contains(HasSubstr("GET scans"))));
}

}  // namespace
}  // namespace hermite::server
