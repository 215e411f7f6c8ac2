// A real server whose store has finished scans without results, and what its routes answer. Header
// only.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/store/store.h"
#include "tests/support/raw_client.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::test {

inline server::ScanRow finished_row(const std::string& id) {
  server::ScanRow row;
  row.id = id;
  row.phase = server::ScanPhase::kFinished;
  row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
  return row;
}

struct RouteAnswer {
  int status = 0;
  std::string header, body;

  nlohmann::json json() const { return nlohmann::json::parse(body, nullptr, false); }
  std::string message() const { return json()["error"]["message"]; }
  std::vector<std::uint8_t> bytes() const { return {body.begin(), body.end()}; }
  std::string field(const std::string& name) const {
    const std::size_t at = header.find("\r\n" + name + ": ");
    return at == std::string::npos
               ? ""
               : header.substr(at + name.size() + 4,
                               header.find("\r\n", at + 2) - at - name.size() - 4);
  }
};

class RouteTest : public testing::Test {
 protected:
  RouteTest() { std::filesystem::create_directories(folder_ / "data"); }

  // Before the server is started.
  void add_scans(const std::vector<server::ScanRow>& rows) const {
    server::Store store(folder_ / "data/hermite.db");
    for (const server::ScanRow& row : rows) {
      EXPECT_TRUE(store.scans.add(row).ok());
      std::filesystem::create_directories(folder_ / "data/scans/" + row.id);
    }
  }
  void put(const std::string& id, const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / "data/scans/" + id + "/" + name, std::ios::binary | std::ios::trunc)
        << bytes;
  }
  // Again, too.
  void start() {
    server_.reset();
    server_ = std::make_unique<RunningServer>(test_options(folder_ / "data"));
  }
  // `headers` end with a line break each.
  RouteAnswer ask(const std::string& method, const std::string& path, const std::string& token,
                  const std::string& body = "", const std::string& headers = "") const {
    RawClient client(server_->port());
    client.send(method + " " + path +
                " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " +
                token + "\r\n" + headers +
                (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") +
                "\r\n" + body);
    const std::string answer = client.read_to_end();
    const std::size_t end = answer.find("\r\n\r\n");
    if (end == std::string::npos) return {};
    return {std::stoi(answer.substr(9, 3)), answer.substr(0, end + 2), answer.substr(end + 4)};
  }
  std::string make_token(const std::string& scopes) const {
    return ask("POST", "/api/v1/tokens", server_->token(), "{\"scopes\": " + scopes + "}")
        .json()["secret"];
  }

  const TemporaryFolder folder_;
  std::unique_ptr<RunningServer> server_;
};

}  // namespace hermite::test
