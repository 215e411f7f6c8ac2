// Exports of scans whose rows are in memory and whose results are files; the threads are in the
// test's hands. Header only.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/exports/exports.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::test {

class ExportsFixture : public testing::Test {
 protected:
  ExportsFixture() { start(); }
  // As a new server would.
  void start() {
    exports_.reset();
    network_.clear();
    making_.clear();
    exports_ = std::make_unique<server::Exports>(
        blobs_, server::Exports::Hooks{
                    [this](std::function<void()> action) { network_.push_back(std::move(action)); },
                    [this](std::function<void()> action) { making_.push_back(std::move(action)); },
                    [this](const std::string& id) -> Result<server::ScanRow> {
                      const auto row = rows_.find(id);
                      return row == rows_.end()
                                 ? Result<server::ScanRow>(
                                       Error{ErrorCode::kNotFound, "there is no scan " + id})
                                 : row->second;
                    },
                    [](const std::string&) -> Result<std::unique_ptr<dataset::Sequence>> {
                      return Error{ErrorCode::kNotFound, "its frames were removed"};
                    },
                    [this](std::uint64_t bytes) {
                      return bytes > room_ ? Status(Error{ErrorCode::kBusy, "no room"}) : Done{};
                    },
                    [this] { ++stored_count_; },
                    [this](const std::string& id) { std::filesystem::remove_all(folder_ / id); }});
    making_.pop_front();  // it would make this thread step back
  }
  // With one result, of this name.
  std::string add_scan_with(const std::string& name, const std::string& bytes,
                            server::ScanPhase phase) {
    server::ScanRow row;
    row.id = server::new_scan_id();
    row.phase = phase;
    row.token_id = "owner";
    row.finished_at_ms = 1000 + static_cast<std::int64_t>(rows_.size());
    rows_[row.id] = row;
    EXPECT_TRUE(blobs_.put(row.id, name, bytes).ok());
    return row.id;
  }
  void remove_scan(const std::string& id) {
    rows_.erase(id);
    std::filesystem::remove_all(folder_ / id);
  }
  static void run_one(std::deque<std::function<void()>>& posted) {
    const auto action = std::move(posted.front());
    posted.pop_front();
    action();
  }
  void make_one() { run_one(making_); }
  void hear() {
    while (!network_.empty()) run_one(network_);
  }
  void settle() {
    for (;;) {
      hear();
      exports_->tick(now_);
      if (making_.empty()) return;
      make_one();
    }
  }
  std::vector<std::string> files(const std::string& scan) {
    std::vector<std::string> names;
    if (std::filesystem::exists(folder_ / scan))
      for (const auto& entry : std::filesystem::directory_iterator(folder_ / scan))
        names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  const TemporaryFolder folder_;
  server::FileBlobs blobs_{folder_.path()};
  std::map<std::string, server::ScanRow> rows_;
  std::deque<std::function<void()>> network_, making_;
  std::uint64_t room_ = 1'000'000'000;
  int stored_count_ = 0;
  server::Exports::Clock::time_point now_ = server::Exports::Clock::now();
  std::unique_ptr<server::Exports> exports_;
};

}  // namespace hermite::test
