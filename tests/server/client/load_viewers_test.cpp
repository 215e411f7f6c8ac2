// Viewers without a server; load_test.cpp has them with one.
#include "server/client/load_viewers.h"

#include <chrono>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

namespace hermite::client::load_viewers_test {
namespace {

using boost::asio::ip::tcp;
using std::chrono::milliseconds;

TEST(LoadViewers, AreManyOnAThread) {
  EXPECT_EQ(load_viewer_threads(0, 2), 1);
  EXPECT_EQ(load_viewer_threads(1, 2), 1);
  EXPECT_EQ(load_viewer_threads(251, 2), 2);
  EXPECT_EQ(load_viewer_threads(10'000, 2), 2);
  EXPECT_EQ(load_viewer_threads(10'000, 0), 1);
}

TEST(LoadViewers, WaitForAScan) {
  LoadScans scans;
  std::atomic<int> watching{0};
  LoadViewers viewers({{"127.0.0.1", 1, "token"}, nullptr, 300}, scans, watching);
  std::this_thread::sleep_for(milliseconds(20));
  const ViewerLoad load = viewers.stop();
  EXPECT_EQ(load.watched + load.refused + load.disconnected + load.messages, 0u);
}

TEST(LoadViewers, SayWhyTheyAreRefused) {
  LoadScans scans;
  scans.begin("scan");
  std::atomic<int> watching{0};
  LoadViewers viewers({{"127.0.0.1", 1, "token"}, nullptr, 3}, scans, watching);
  std::this_thread::sleep_for(milliseconds(300));
  const ViewerLoad load = viewers.stop();
  EXPECT_GE(load.refused, 1u);
  EXPECT_EQ(load.watched, 0u);
  ASSERT_EQ(load.problems.size(), 1u);
  EXPECT_THAT(load.problems.begin()->first, testing::HasSubstr("cannot connect to 127.0.0.1:1"));
  EXPECT_EQ(scans.take(), "scan");
}

// The system completes connections that nobody accepts.
TEST(LoadViewers, AreStoppedWhileTheServerIsSilent) {
  boost::asio::io_context io;
  tcp::acceptor silent(io, {boost::asio::ip::address_v4::loopback(), 0});
  LoadScans scans;
  scans.begin("scan");
  std::atomic<int> watching{0};
  LoadViewersPlan plan{{"127.0.0.1", silent.local_endpoint().port(), "token"}, nullptr, 2};
  plan.patience = std::chrono::hours(1);
  LoadViewers viewers(plan, scans, watching);
  std::this_thread::sleep_for(milliseconds(100));
  const ViewerLoad load = viewers.stop();
  EXPECT_EQ(load.watched + load.refused, 0u);
  EXPECT_EQ(watching, 0);
}

}  // namespace
}  // namespace hermite::client::load_viewers_test
