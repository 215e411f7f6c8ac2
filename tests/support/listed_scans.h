// A server whose data folder has rows of ended scans, for tests of what a client does with them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/client/scans.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::test {

class ListedScans : public testing::Test {
 protected:
  // `describe(row, i)` completes the rows; the last one is the newest.
  template <class Describe>
  void serve_rows(int scan_count, const Describe& describe) {
    std::filesystem::create_directories(folder_ / "data");
    {
      server::Store store(folder_ / "data/hermite.db");
      for (int i = 0; i < scan_count; ++i) {
        server::ScanRow row;
        row.id = server::new_scan_id();
        row.phase = server::ScanPhase::kFinished;
        row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
        row.created_at_ms = 1'714'564'800'000 + i;
        row.finished_at_ms = row.created_at_ms + 60'000;
        describe(row, i);
        ASSERT_TRUE(store.scans.add(row).ok());
        ids_.push_back(row.id);
      }
    }
    server_ = std::make_unique<RunningServer>(test_options(folder_ / "data"));
    target_.server = {"127.0.0.1", static_cast<std::uint16_t>(server_->port()), server_->token(),
                      false};
  }

  const TemporaryFolder folder_;
  std::vector<std::string> ids_;
  std::unique_ptr<RunningServer> server_;
  client::ApiTarget target_;
};

}  // namespace hermite::test
