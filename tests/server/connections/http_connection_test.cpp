// What the server says over HTTP, asked by hand.
#include "server/connections/http_connection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class HttpTest : public testing::Test {
 protected:
  HttpTest() {
    std::filesystem::create_directories(folder_ / "web/assets");
    std::ofstream(folder_ / "web/index.html") << "<html>the viewer";
    std::ofstream(folder_ / "web/assets/code-1.js") << "code";
    std::ofstream(folder_ / "secret.txt") << "a secret";
    // A scan of an earlier life of the server.
    std::filesystem::create_directories(folder_ / "data/scans/" + id_);
    std::ofstream(folder_ / "data/scans/" + id_ + "/cloud.ply") << "ply points";
    ScanRow row;
    row.id = id_;
    row.title = "a \"title\"";
    row.phase = ScanPhase::kFinished;
    row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
    row.frames_processed = 12;
    row.created_at_ms = 1'700'000'000'123;
    {
      Store store(folder_ / "data/hermite.db");
      EXPECT_TRUE(store.scans.add(row).ok());
    }
    ServiceOptions options = test::test_options(folder_ / "data");
    options.web_folder = folder_ / "web";
    server_ = std::make_unique<test::RunningServer>(options);
  }

  // The whole answer to these bytes, to the end of the connection.
  std::string exchange(const std::string& bytes) {
    test::RawClient client(server_->port());
    client.send(bytes);
    return client.read_to_end();
  }
  std::string request(const std::string& method, const std::string& path,
                      const std::string& headers = "") {
    return exchange(method + " " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                    headers + "\r\n");
  }
  std::string get(const std::string& path, const std::string& headers = "") {
    return request("GET", path, headers);
  }
  std::string with_token() const { return "Authorization: Bearer " + server_->token() + "\r\n"; }

  const test::TemporaryFolder folder_;
  const std::string id_ = new_scan_id();
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(HttpTest, HealthNeedsNoToken) { EXPECT_THAT(get("/healthz"), StartsWith("HTTP/1.1 200")); }

TEST_F(HttpTest, TheViewerComesWithItsSecurityHeaders) {
  const std::string answer = get("/");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("<html>the viewer"));
  EXPECT_THAT(answer, HasSubstr("Content-Type: text/html; charset=utf-8\r\n"));
  EXPECT_THAT(answer, HasSubstr("script-src 'self' 'wasm-unsafe-eval'"));
  EXPECT_THAT(answer, HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(answer, HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_THAT(answer, HasSubstr("Referrer-Policy: no-referrer"));
  EXPECT_THAT(get("/assets/code-1.js"), HasSubstr("immutable"));
}

TEST_F(HttpTest, OtherSitesMayShowTheViewerInAFrameWhenTheOperatorNamesThem) {
  std::ofstream(folder_ / "web/hermite-viewer.js") << "the element";
  ServiceOptions options = test::test_options(folder_ / "data");
  options.web_folder = folder_ / "web";
  options.embed_in = {"https://example.org", "https://*.lab.example"};
  server_.reset();
  server_ = std::make_unique<test::RunningServer>(options);
  EXPECT_THAT(get("/"), HasSubstr("frame-ancestors https://example.org https://*.lab.example\r\n"));
  EXPECT_THAT(get("/hermite-viewer.js"),
              HasSubstr("Cross-Origin-Resource-Policy: cross-origin\r\n"));
  EXPECT_THAT(get("/assets/code-1.js"), HasSubstr("Cross-Origin-Resource-Policy: same-origin\r\n"));
  EXPECT_THAT(get("/api/v1/scans", with_token()), HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(get("/api/v1/access", with_token()), HasSubstr("\"embedding\":true"));
}

TEST_F(HttpTest, HeadIsGetWithoutTheBody) {
  const std::string answer = request("HEAD", "/");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("Content-Length: 16\r\n"));
  EXPECT_THAT(answer, Not(HasSubstr("<html>")));
}

TEST_F(HttpTest, NoPathLeadsOutOfTheFolder) {
  for (const char* path : {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt",
                           "/assets//../index.html", "/..%2fsecret.txt", "//etc/passwd",
                           "/index.html/", "/assets", "/secret.txt"}) {
    const std::string answer = get(path);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 404")) << path;
    EXPECT_THAT(answer, Not(HasSubstr("a secret"))) << path;
  }
}

TEST_F(HttpTest, TheApiNeedsTheToken) {
  for (const std::string& headers :
       {std::string(), std::string("Authorization: Bearer wrong\r\n"),
        "Authorization: Basic " + server_->token() + "\r\n",
        "Authorization: Bearer " + server_->token() + "x\r\n",
        "Authorization: Bearer " + server_->token().substr(1) + "\r\n"}) {
    const std::string answer = get("/api/v1/scans", headers);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 401"));
    EXPECT_THAT(answer, HasSubstr("WWW-Authenticate: Bearer"));
    EXPECT_THAT(answer, HasSubstr("unauthorized"));
  }
  EXPECT_THAT(get("/api/v1/scans?token=" + server_->token()), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(get("/api/anything"), StartsWith("HTTP/1.1 401"));
}

TEST_F(HttpTest, ListsAndShowsScans) {
  const std::string list = get("/api/v1/scans", with_token());
  EXPECT_THAT(list, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(list, HasSubstr("Content-Type: application/json"));
  EXPECT_THAT(list,
              HasSubstr("{\"scans\":[{\"id\":\"" + id_ +
                        "\",\"title\":\"a \\\"title\\\"\",\"tags\":[],\"state\":\"finished\""));
  EXPECT_THAT(list, HasSubstr("\"created_at\":\"2023-11-14T22:13:20.123Z\""));
  EXPECT_THAT(get("/api/v1/scans/" + id_, with_token()), HasSubstr("\"frames\":12"));
  EXPECT_THAT(get("/api/v1/scans/" + new_scan_id(), with_token()), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/api/v1/scans/..", with_token()), StartsWith("HTTP/1.1 404"));
}

TEST_F(HttpTest, SendsTheFilesOfAScan) {
  const std::string cloud = get("/api/v1/scans/" + id_ + "/cloud.ply", with_token());
  EXPECT_THAT(cloud, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(cloud, HasSubstr("Content-Length: 10\r\n"));
  EXPECT_THAT(cloud, HasSubstr("attachment; filename=\"" + id_ + "-cloud.ply\""));
  EXPECT_THAT(cloud, HasSubstr("ply points"));
  EXPECT_THAT(request("HEAD", "/api/v1/scans/" + id_ + "/cloud.ply", with_token()),
              Not(HasSubstr("ply points")));
  EXPECT_THAT(get("/api/v1/scans/" + id_ + "/report.json", with_token()),
              StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/api/v1/scans/" + id_ + "/chunks.bin", with_token()),
              StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/api/v1/scans/../../hermite.db/cloud.ply", with_token()),
              StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/api/v1/scans/" + id_ + "/cloud.ply"), StartsWith("HTTP/1.1 401"));
}

TEST_F(HttpTest, SendsAPartOfAFile) {
  const std::string path = "/api/v1/scans/" + id_ + "/cloud.ply";
  const std::string part = get(path, with_token() + "Range: bytes=4-8\r\n");
  EXPECT_THAT(part, StartsWith("HTTP/1.1 206"));
  EXPECT_THAT(part, HasSubstr("Content-Length: 5\r\n"));
  EXPECT_THAT(part, HasSubstr("Content-Range: bytes 4-8/10\r\n"));
  EXPECT_THAT(part, testing::EndsWith("\r\n\r\npoint"));
  EXPECT_THAT(get(path, with_token() + "Range: bytes=10-\r\n"), StartsWith("HTTP/1.1 416"));

  const std::string head = request("HEAD", path, with_token());
  const std::size_t tag = head.find("ETag: ");
  ASSERT_NE(tag, std::string::npos) << head;
  const std::string version = head.substr(tag + 6, head.find('\r', tag) - tag - 6);
  EXPECT_THAT(get(path, with_token() + "Range: bytes=-2\r\nIf-Range: " + version + "\r\n"),
              testing::EndsWith("\r\n\r\nts"));
  std::ofstream(folder_ / "data/scans/" + id_ + "/cloud.ply") << "ply other points";
  EXPECT_THAT(get(path, with_token() + "Range: bytes=-2\r\nIf-Range: " + version + "\r\n"),
              testing::EndsWith("\r\n\r\nply other points"));
}

TEST_F(HttpTest, RemovesAScan) {
  EXPECT_THAT(request("DELETE", "/api/v1/scans/" + id_), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(request("DELETE", "/api/v1/scans/" + id_, with_token()), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get("/api/v1/scans/" + id_, with_token()), StartsWith("HTTP/1.1 404"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data/scans/" + id_));
  EXPECT_THAT(request("DELETE", "/api/v1/scans/" + id_, with_token()), StartsWith("HTTP/1.1 404"));
}

TEST_F(HttpTest, OtherMethodsAreNamed) {
  EXPECT_THAT(request("POST", "/"), StartsWith("HTTP/1.1 405"));
  const std::string answer = request("DELETE", "/api/v1/scans", with_token());
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(answer, HasSubstr("Allow: GET, HEAD\r\n"));
  EXPECT_THAT(request("GET", "/api/v1/uploads/" + id_, with_token()),
              HasSubstr("Allow: HEAD, PATCH, DELETE, PUT\r\n"));
  for (const char* other : {"BREW", "TRACE"})
    EXPECT_THAT(request(other, "/"), StartsWith("HTTP/1.1 405")) << other;
}

TEST_F(HttpTest, OtherHostsAndOriginsAreRefused) {
  EXPECT_THAT(exchange("GET / HTTP/1.1\r\nHost: evil.com\r\n\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(exchange("GET / HTTP/1.1\r\nHost: localhost.evil.com:80\r\n\r\n"),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(exchange("GET / HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(exchange("GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n"),
              StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get("/healthz", "Origin: http://evil.com\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/healthz", "Origin: null\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/healthz", "Origin: http://localhost:5173\r\n"), StartsWith("HTTP/1.1 200"));
}

TEST_F(HttpTest, BodiesAndTransferCodingsAreRefusedAndTheConnectionEnds) {
  const std::string smuggled = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
  for (const char* header : {"Transfer-Encoding: chunked", "Transfer-Encoding: identity",
                             "Transfer-Encoding: chunked, identity", "Content-Length: 46",
                             "Content-Length: 46\r\nTransfer-Encoding: chunked",
                             "Content-Length: 5\r\nContent-Length: 6"}) {
    const std::string answer =
        exchange(std::string("GET /healthz HTTP/1.1\r\nHost: localhost\r\n") + header + "\r\n\r\n" +
                 smuggled);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 4")) << header;
    EXPECT_THAT(answer, Not(HasSubstr("HTTP/1.1 200"))) << header;
    EXPECT_THAT(answer, HasSubstr("Connection: close")) << header;
  }
  EXPECT_THAT(exchange("GET /healthz HTTP/1.0\r\nHost: localhost\r\nTransfer-Encoding: "
                       "chunked\r\n\r\n0\r\n\r\n"),
              HasSubstr(" 400 "));
}

TEST_F(HttpTest, APostMayHaveASmallBody) {
  const auto post = [this](const std::string& body, const std::string& more = "") {
    return exchange("POST /api/v1/tokens HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                    with_token() + more + "Content-Length: " + std::to_string(body.size()) +
                    "\r\n\r\n" + body);
  };
  EXPECT_THAT(post("{}"), StartsWith("HTTP/1.1 201"));
  const std::string padded = "{" + std::string(kMaxBodyBytes - 2, ' ') + "}";
  EXPECT_THAT(post(padded), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(post(padded + " "), StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(post("{}", "Transfer-Encoding: chunked\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(exchange("POST /api/v1/tokens HTTP/1.1\r\nHost: localhost\r\n" + with_token() +
                       "Content-Length: 99999999999999999\r\n\r\n"),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(exchange("POST /api/v1/tokens HTTP/1.1\r\nHost: localhost\r\n" + with_token() +
                       "Content-Length: -1\r\n\r\n"),
              StartsWith("HTTP/1.1 400"));
}

TEST_F(HttpTest, ABodyThatIsCutEndsTheConnection) {
  test::RawClient client(server_->port());
  client.send("POST /api/v1/tokens HTTP/1.1\r\nHost: localhost\r\n" + with_token() +
              "Content-Length: 10\r\n\r\n{");
  client.drop();
  EXPECT_THAT(get("/healthz"), StartsWith("HTTP/1.1 200")) << "the server lives";
}

TEST_F(HttpTest, ARefusedRequestsAnswerArrivesThoughItsBodyWasNotRead) {
  const std::string answer =
      exchange("POST /api/v1/tokens HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n" +
               std::string(100'000, 'x'));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(answer, HasSubstr("allowed are 4096"));
}

TEST_F(HttpTest, EveryAnswerHasTheSecurityHeadersAndTheTime) {
  for (const std::string& answer :
       {get("/"), get("/healthz"), get("/nothing"), get("/api/v1/scans"),
        get("/api/v1/scans", with_token()),
        get("/api/v1/scans/" + id_ + "/cloud.ply", with_token()), request("POST", "/"),
        exchange("garbage\r\n\r\n"), get("/", "X: " + std::string(kMaxHeaderBytes, 'x') + "\r\n"),
        get("/", "Origin: http://evil.com\r\n")}) {
    for (const char* header :
         {"Content-Security-Policy: default-src 'none'", "X-Content-Type-Options: nosniff",
          "Referrer-Policy: no-referrer", "Cross-Origin-Opener-Policy: same-origin",
          "Cross-Origin-Resource-Policy: same-origin", "Cache-Control: ", "Date: ", " GMT\r\n"})
      EXPECT_THAT(answer, HasSubstr(header)) << answer.substr(0, 40);
  }
}

TEST_F(HttpTest, LongHeadersAndGarbageAreRefused) {
  EXPECT_THAT(get("/", "X: " + std::string(kMaxHeaderBytes, 'x') + "\r\n"),
              StartsWith("HTTP/1.1 431"));
  for (const std::string& bytes :
       {std::string("garbage\r\n\r\n"), std::string(64, '\0') + "\r\n\r\n",
        std::string("GET / HTTP/9.9\r\n\r\n"),
        std::string("GET http://evil.com/ HTTP/1.1\r\nHost: localhost\r\n\r\n")}) {
    const std::string answer = exchange(bytes);
    EXPECT_TRUE(answer.empty() || answer.find("HTTP/1.1 4") == 0 || answer.find("HTTP/1.1 5") == 0)
        << answer;
  }
  EXPECT_THAT(get("/healthz"), StartsWith("HTTP/1.1 200")) << "the server lives";
}

TEST_F(HttpTest, AConnectionServesOneRequestAfterTheOther) {
  test::RawClient client(server_->port());
  for (int i = 0; i < 3; ++i) {
    client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const std::string header = client.read_header();
    EXPECT_THAT(header, StartsWith(i == 0 ? "HTTP/1.1 200" : "ok\nHTTP/1.1 200"));
  }
}

}  // namespace
}  // namespace hermite::server
