#include "server/client/http_exchange.h"

#include <gtest/gtest.h>

#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client {
namespace {

TEST(HttpExchange, AnAnswerHasStatusFieldsAndBody) {
  const test::TemporaryFolder folder;
  const test::RunningServer server(test::test_options(folder / "data"));
  const ServerUrl url{"127.0.0.1", static_cast<std::uint16_t>(server.port()), server.token(),
                      false};
  const Result<HttpReply> well = http_exchange(url, nullptr, true, {"GET", "/healthz", {}, ""});
  ASSERT_TRUE(well.ok());
  EXPECT_EQ(well->status, 200);
  EXPECT_EQ(well->body, "ok\n");
  EXPECT_EQ(well->field("content-length"), "3");
  EXPECT_EQ(well->field("ontent-Length"), std::nullopt);
  const Result<HttpReply> head = http_exchange(url, nullptr, true, {"HEAD", "/healthz", {}, ""});
  ASSERT_TRUE(head.ok()) << "a HEAD has no body, whatever its length says";
  const Result<HttpReply> none =
      http_exchange(url, nullptr, true, {"GET", "/api/v1/scans/x", {}, ""});
  ASSERT_TRUE(none.ok()) << "a refusal is an answer";
  EXPECT_EQ(none->status, 404);
}

TEST(HttpExchange, NobodyThereIsSaidWithoutTheToken) {
  const Result<HttpReply> reply =
      http_exchange({"127.0.0.1", 1, "secret", false}, nullptr, true, {"GET", "/healthz", {}, ""});
  ASSERT_FALSE(reply.ok());
  EXPECT_EQ(reply.error().code, ErrorCode::kIo);
  EXPECT_EQ(reply.error().message.find("secret"), std::string::npos);
}

TEST(HttpExchange, ARefusalIsTheServersMessageWithACode) {
  const auto refused = [](int status, const std::string& body) {
    return refusal({status, "", body});
  };
  EXPECT_EQ(refused(404, R"({"error": {"message": "no such thing"}})").message, "no such thing");
  EXPECT_EQ(refused(500, "garbage").message, "it answered with HTTP 500");
  const std::pair<int, ErrorCode> codes[] = {{401, ErrorCode::kUnauthorized},
                                             {403, ErrorCode::kUnauthorized},
                                             {404, ErrorCode::kNotFound},
                                             {409, ErrorCode::kBusy},
                                             {413, ErrorCode::kTooLarge},
                                             {423, ErrorCode::kBusy},
                                             {503, ErrorCode::kBusy},
                                             {400, ErrorCode::kInvalidArgument},
                                             {507, ErrorCode::kIo}};
  for (const auto& [status, code] : codes) EXPECT_EQ(refused(status, "").code, code) << status;
}

}  // namespace
}  // namespace hermite::client
