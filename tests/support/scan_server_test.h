// Tests of scans on a real server with a real pipeline, of cameras that a test plays by hand.
// Header only.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/pipeline/doctor.h"
#include "tests/support/raw_client.h"
#include "tests/support/room_frames.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::test {

// Skips where no device can reconstruct.
class ScanServerTest : public testing::Test {
 protected:
  using Role = std::variant<wire::StartScan, wire::ViewScan, wire::ResumeScan>;

  void SetUp() override {
    static const std::vector<std::string> problems = pipeline::examine_device("").problems;
    if (!problems.empty()) GTEST_SKIP() << "no fit GPU here: " << problems.front();
    serve([](server::ServiceOptions&) {});
  }

  // Another server on the same folder, in place of the one that runs.
  void serve(const std::function<void(server::ServiceOptions&)>& change) {
    server_.reset();
    server::ServiceOptions options = test_options(folder_ / "data");
    change(options);
    server_ = std::make_unique<RunningServer>(options);
  }

  // A connection that has said who it is; the answer is the test's business.
  std::unique_ptr<RawClient> hello(const Role& role,
                                   std::uint32_t protocol_minor = wire::kProtocolMinor) {
    return hello_with(server_->token(), role, protocol_minor);
  }
  std::unique_ptr<RawClient> hello_with(const std::string& token, const Role& role,
                                        std::uint32_t protocol_minor = wire::kProtocolMinor) {
    auto client = std::make_unique<RawClient>(server_->port());
    EXPECT_TRUE(client->upgrade());
    client->send_message(wire::Hello{protocol_minor, "test", token, role});
    return client;
  }

  // `id_and_rest`: empty for the list of scans. Returns the answer's JSON.
  nlohmann::json ask_http(const std::string& method, const std::string& id_and_rest) {
    RawClient client(server_->port());
    client.send(method + " /api/v1/scans" + (id_and_rest.empty() ? "" : "/" + id_and_rest) +
                " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
                server_->token() + "\r\n\r\n");
    const std::string answer = client.read_to_end();
    return nlohmann::json::parse(answer.substr(answer.find("\r\n\r\n") + 4));
  }

  const TemporaryFolder folder_;
  std::unique_ptr<RunningServer> server_;
};

}  // namespace hermite::test
