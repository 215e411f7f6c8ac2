// Uploads over HTTP on a real server, asked by hand. What is sent is no recording, so that no job
// takes time.
#include "server/routes/upload_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/digest/sha256.h"
#include "server/net/base64.h"
#include "server/store/secret.h"
#include "tests/support/memory_peak.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class UploadRoutesTest : public testing::Test {
 protected:
  UploadRoutesTest() { start(); }
  void start() {
    server_.reset();
    ServiceOptions options = test::test_options(folder_ / "data");
    options.max_upload_gb = 1;
    server_ = std::make_unique<test::RunningServer>(options);
  }

  struct Answer {
    int status = 0;
    std::string header, body;
    std::string field(const std::string& name) const {
      const std::size_t at = header.find("\r\n" + name + ": ");
      if (at == std::string::npos) return "none";
      const std::size_t from = at + name.size() + 4;
      return header.substr(from, header.find("\r\n", from) - from);
    }
  };
  std::string head_of(const std::string& method, const std::string& path,
                      const std::string& headers, std::size_t body_bytes,
                      const std::string& token = "") {
    return method + " " + path +
           " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
           (token.empty() ? server_->token() : token) + "\r\n" + headers +
           (body_bytes == 0 ? "" : "Content-Length: " + std::to_string(body_bytes) + "\r\n") +
           "\r\n";
  }
  static Answer answer_of(const std::string& bytes) {
    const std::size_t end = bytes.find("\r\n\r\n");
    if (end == std::string::npos) return {};
    return {std::stoi(bytes.substr(9, 3)), bytes.substr(0, end + 2), bytes.substr(end + 4)};
  }
  Answer ask(const std::string& method, const std::string& path, const std::string& headers,
             const std::string& body = "", const std::string& token = "") {
    test::RawClient client(server_->port());
    client.send(head_of(method, path, headers, body.size(), token) + body);
    return answer_of(client.read_to_end());
  }
  Answer tus(const std::string& method, const std::string& path, const std::string& headers = "",
             const std::string& body = "", const std::string& token = "") {
    const std::string type = body.empty() && method != "PATCH"
                                 ? ""
                                 : "Content-Type: application/offset+octet-stream\r\n";
    return ask(method, path, "Tus-Resumable: 1.0.0\r\n" + type + headers, body, token);
  }
  std::string create(const std::string& headers) {
    return tus("POST", "/api/v1/uploads", headers).field("Location");
  }
  std::string make_token(const std::string& scopes) {
    return nlohmann::json::parse(
        ask("POST", "/api/v1/tokens", "", "{\"scopes\": " + scopes + "}").body)["secret"];
  }
  std::string file_of(const std::string& location) {
    std::ifstream file(folder_ / ("data/uploads/" + location.substr(location.rfind('/') + 1)),
                       std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  std::string job_message(const std::string& id) {
    for (int i = 0; i < 600; ++i) {
      const nlohmann::json job = nlohmann::json::parse(ask("GET", "/api/v1/jobs/" + id, "").body);
      if (job["state"] == "failed") return job["words"];
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return "it did not fail";
  }

  const test::TemporaryFolder folder_;
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(UploadRoutesTest, SaysWhatItCan) {
  const Answer answer = ask("OPTIONS", "/api/v1/uploads", "");
  EXPECT_EQ(answer.status, 204);
  EXPECT_EQ(answer.field("Tus-Version"), "1.0.0");
  EXPECT_EQ(answer.field("Tus-Max-Size"), "1000000000");
  EXPECT_THAT(answer.field("Tus-Extension"), HasSubstr("termination"));
  EXPECT_EQ(answer.field("Tus-Checksum-Algorithm"), "sha1,sha256");
  EXPECT_EQ(answer.field("Content-Length"), "none") << "a 204 has none";
}

TEST_F(UploadRoutesTest, PiecesGoWhereTheLastOneEnded) {
  const Answer made =
      tus("POST", "/api/v1/uploads", "Upload-Length: 11\r\nUpload-Metadata: filename YS50YXI=\r\n");
  EXPECT_EQ(made.status, 201);
  EXPECT_EQ(made.field("Tus-Resumable"), "1.0.0");
  EXPECT_THAT(made.field("Upload-Expires"), HasSubstr(" GMT"));
  const std::string location = made.field("Location");
  EXPECT_THAT(location, StartsWith("/api/v1/uploads/"));
  const Answer first = tus("PATCH", location, "Upload-Offset: 0\r\n", "hello ");
  EXPECT_EQ(first.status, 204);
  EXPECT_EQ(first.field("Upload-Offset"), "6");
  const Answer looked = tus("HEAD", location);
  EXPECT_EQ(looked.status, 200);
  EXPECT_EQ(looked.field("Upload-Offset"), "6");
  EXPECT_EQ(looked.field("Upload-Length"), "11");
  EXPECT_EQ(looked.field("Upload-Metadata"), "filename YS50YXI=");
  EXPECT_EQ(looked.field("Cache-Control"), "no-store");
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 5\r\n", "world").status, 409);
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 6\r\n", "worlds").status, 413);
  EXPECT_EQ(file_of(location), "hello ");
  start();  // a restart changes nothing
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 6\r\n", "world").field("Upload-Offset"), "11");
  EXPECT_EQ(file_of(location), "hello world");
  EXPECT_THAT(job_message(location.substr(location.rfind('/') + 1)),
              HasSubstr("is no recording we know"));
}

TEST_F(UploadRoutesTest, TheCreationMayHaveTheFirstPiece) {
  const Answer made = tus("POST", "/api/v1/uploads", "Upload-Length: 100\r\n", "hello");
  EXPECT_EQ(made.status, 201);
  EXPECT_EQ(made.field("Upload-Offset"), "5");
  EXPECT_EQ(file_of(made.field("Location")), "hello");
}

TEST_F(UploadRoutesTest, ACreationWhoseFirstPieceIsDamagedLeavesNothing) {
  const Answer refused =
      tus("POST", "/api/v1/uploads",
          "Upload-Length: 100\r\nUpload-Checksum: sha1 2jmj7l5rSw0yVb/vlWAYkK/YBwk=\r\n", "hello");
  EXPECT_EQ(refused.status, 460);
  EXPECT_EQ(refused.field("Tus-Resumable"), "1.0.0");
  EXPECT_EQ(refused.field("Location"), "none");
  EXPECT_TRUE(nlohmann::json::parse(ask("GET", "/api/v1/uploads", "").body)["uploads"].empty())
      << "it would count until it expires";
}

TEST_F(UploadRoutesTest, TheLengthMayFollow) {
  const std::string location = create("Upload-Defer-Length: 1\r\n");
  EXPECT_EQ(tus("HEAD", location).field("Upload-Defer-Length"), "1");
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 0\r\n", "hello").status, 204);
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 5\r\nUpload-Length: 3\r\n", "x").status, 400);
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 5\r\nUpload-Length: 10\r\n", "wor").status, 204);
  EXPECT_EQ(tus("HEAD", location).field("Upload-Length"), "10");
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 8\r\nUpload-Length: 11\r\n", "ld").status, 400)
      << "it is known now";
}

TEST_F(UploadRoutesTest, ChecksumsAreChecked) {
  const std::string location = create("Upload-Length: 20\r\n");
  const std::string wrong = "Upload-Checksum: sha1 2jmj7l5rSw0yVb/vlWAYkK/YBwk=\r\n";
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 0\r\n" + wrong, "hello").status,
            kChecksumMismatch);
  EXPECT_EQ(tus("HEAD", location).field("Upload-Offset"), "0");
  EXPECT_EQ(tus("PATCH", location,
                "Upload-Offset: 0\r\nUpload-Checksum: sha1 Kq5sNclPz7QV2+lfQIuc6R7oRu0=\r\n",
                "hello world")
                .status,
            204);
  const std::string right =
      "Upload-Checksum: sha256 " + encode_base64(digest::sha256("!")) + "\r\n";
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 11\r\n" + right, "!").status, 204);
  EXPECT_EQ(
      tus("PATCH", location, "Upload-Offset: 12\r\nUpload-Checksum: md5 xxxx\r\n", "!").status,
      400);
}

TEST_F(UploadRoutesTest, WhatIsNoTusIsRefusedWithAMessage) {
  EXPECT_EQ(ask("POST", "/api/v1/uploads", "Upload-Length: 5\r\n").status, 412);
  EXPECT_EQ(ask("POST", "/api/v1/uploads", "Upload-Length: 5\r\nTus-Resumable: 0.2.2\r\n")
                .field("Tus-Version"),
            "1.0.0");
  EXPECT_EQ(tus("POST", "/api/v1/uploads").status, 400);
  EXPECT_EQ(tus("POST", "/api/v1/uploads", "Upload-Length: 1000000001\r\n").status, 413);
  EXPECT_EQ(tus("POST", "/api/v1/uploads", "Upload-Length: -1\r\n").status, 400);
  EXPECT_THAT(
      tus("POST", "/api/v1/uploads", "Upload-Length: 5\r\nUpload-Metadata: priority OTk5\r\n").body,
      HasSubstr("priority must be a whole"));
  const std::string first = "Upload-Length: 5\r\nUpload-Metadata: priority MQ==\r\n";
  EXPECT_EQ(tus("POST", "/api/v1/uploads", first, "", make_token(R"(["view", "scan"])")).status,
            403)
      << "that is for administrators";
  EXPECT_EQ(tus("POST", "/api/v1/uploads", first).status, 201);
  const std::string location = create("Upload-Length: 5\r\n");
  EXPECT_EQ(ask("PATCH", location, "Tus-Resumable: 1.0.0\r\nUpload-Offset: 0\r\n", "hello").status,
            415);
  EXPECT_EQ(tus("PATCH", location, "", "hello").status, 400) << "no offset";
  EXPECT_EQ(ask("PATCH", location,
                "Tus-Resumable: 1.0.0\r\nTransfer-Encoding: chunked\r\nUpload-Offset: 0\r\n")
                .status,
            400);
  EXPECT_EQ(file_of(location), "");
}

TEST_F(UploadRoutesTest, NoPathOfAClientReachesTheDisk) {
  for (const char* path : {"/api/v1/uploads/..", "/api/v1/uploads/%2e%2e%2fhermite.db",
                           "/api/v1/uploads/../token", "/api/v1/uploads/x"})
    EXPECT_EQ(tus("HEAD", path).status, 404) << path;
  const Answer put = ask("PUT", "/api/v1/uploads/..%2f..%2fevil%00.tar", "", "no recording");
  EXPECT_EQ(put.status, 201);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
    names.push_back(entry.path().filename().string());
  EXPECT_THAT(names, testing::Each(Not(HasSubstr("evil"))));
}

TEST_F(UploadRoutesTest, ATokenSeesItsOwnUploadsOnly) {
  const std::string mine = make_token(R"(["scan"])"), other = make_token(R"(["scan"])"),
                    viewer = make_token(R"(["view"])");
  EXPECT_EQ(tus("POST", "/api/v1/uploads", "Upload-Length: 5\r\n", "", viewer).status, 403);
  const std::string location =
      tus("POST", "/api/v1/uploads", "Upload-Length: 5\r\n", "", mine).field("Location");
  EXPECT_EQ(tus("HEAD", location, "", "", mine).status, 200);
  EXPECT_EQ(tus("HEAD", location, "", "", other).status, 404);
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 0\r\n", "hello", other).status, 404);
  EXPECT_EQ(tus("DELETE", location, "", "", other).status, 404);
  EXPECT_THAT(ask("GET", "/api/v1/uploads", "", "", other).body, HasSubstr("\"uploads\":[]"));
  EXPECT_THAT(ask("GET", "/api/v1/uploads", "", "", mine).body, HasSubstr("\"length\":5"));
}

TEST_F(UploadRoutesTest, OneThatIsTerminatedIsGone) {
  const std::string location = create("Upload-Length: 50\r\n");
  tus("PATCH", location, "Upload-Offset: 0\r\n", "hello");
  EXPECT_EQ(tus("DELETE", location).status, 204);
  EXPECT_EQ(tus("HEAD", location).status, 404);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "data/uploads"));
}

TEST_F(UploadRoutesTest, ARequestThatHangsMakesWayForTheNextWhatCameStays) {
  const std::string location = create("Upload-Length: 11\r\n");
  test::RawClient hanging(server_->port());
  hanging.send(head_of("PATCH", location,
                       "Tus-Resumable: 1.0.0\r\nContent-Type: "
                       "application/offset+octet-stream\r\nUpload-Offset: 0\r\n",
                       11) +
               "hello");
  // Until the server is reading it.
  for (int i = 0; i < 500 && ask("GET", "/api/v1/uploads", "").body.find("\"offset\":null") ==
                                 std::string::npos;
       ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(tus("HEAD", location).field("Upload-Offset"), "5");
  EXPECT_EQ(tus("PATCH", location, "Upload-Offset: 5\r\n", " world").status, 204);
  EXPECT_EQ(file_of(location), "hello world");
}

TEST_F(UploadRoutesTest, APlainPutIsARecordingInOneRequest) {
  test::RawClient client(server_->port());
  client.send(head_of("PUT", "/api/v1/uploads/my%20room.tar", "Expect: 100-continue\r\n", 12));
  EXPECT_THAT(client.read_header(), StartsWith("HTTP/1.1 100 "));
  client.send("no recording");
  const Answer answer = answer_of(client.read_to_end());
  EXPECT_EQ(answer.status, 201);
  const std::string id = nlohmann::json::parse(answer.body)["job"];
  EXPECT_THAT(job_message(id), StartsWith("my room is no recording we know"));
  EXPECT_EQ(ask("PUT", "/api/v1/uploads/a.tar", "").status, 411);
  test::RawClient cut(server_->port());
  cut.send(head_of("PUT", "/api/v1/uploads/cut.tar", "", 100) + "not all");
  cut.drop();
  for (int i = 0;
       i < 500 && ask("GET", "/api/v1/uploads", "").body.find("cut") != std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_THAT(ask("GET", "/api/v1/uploads", "").body, Not(HasSubstr("cut")))
      << "nobody could go on with it";
}

TEST_F(UploadRoutesTest, ALongBodyTakesNoMemory) {
  const std::string location = create("Upload-Length: 67108864\r\n");
  test::RawClient client(server_->port());
  client.send(head_of("PATCH", location,
                      "Tus-Resumable: 1.0.0\r\nContent-Type: "
                      "application/offset+octet-stream\r\nUpload-Offset: 0\r\n",
                      67108863));
  const std::string megabyte(1 << 20, 'x');
  const std::size_t growth_bytes = test::peak_growth_bytes([&] {
    for (int i = 0; i < 63; ++i) client.send(megabyte);
  });
  EXPECT_LT(growth_bytes, std::size_t{16} << 20);
  client.send(megabyte.substr(1));
  EXPECT_EQ(answer_of(client.read_to_end()).field("Upload-Offset"), "67108863");
}

TEST_F(UploadRoutesTest, OfManyPiecesAtTheSameTimeOneGetsThrough) {
  const std::string location = create("Upload-Length: 5\r\n");
  std::vector<std::unique_ptr<test::RawClient>> clients;
  const std::string headers =
      "Tus-Resumable: 1.0.0\r\nContent-Type: application/offset+octet-stream\r\nUpload-Offset: "
      "0\r\n";
  for (int i = 0; i < 6; ++i) {
    clients.push_back(std::make_unique<test::RawClient>(server_->port()));
    clients.back()->send(head_of("PATCH", location, headers, 5) + "he");
  }
  for (const auto& client : clients) client->send("llo");
  std::map<int, int> answers;
  for (const auto& client : clients) ++answers[answer_of(client->read_to_end()).status];
  EXPECT_EQ(answers[204], 1);
  EXPECT_EQ(answers[204] + answers[409] + answers[423] + answers[404], 6) << "the others are told";
}

}  // namespace
}  // namespace hermite::server
