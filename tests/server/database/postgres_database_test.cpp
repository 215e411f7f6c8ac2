#include "server/database/postgres_database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <memory>

#include "tests/server/store/store_contract.h"
#include "tests/support/postgres/postgres_server.h"

namespace hermite::server {
namespace {

using test::LossyProxy;
using test::PostgresServer;
using test::scan_row;
using testing::HasSubstr;
using Fate = LossyProxy::Fate;

class PostgresWorld {
 public:
  static std::string missing() { return PostgresServer::missing(); }
  Store& store() { return *store_; }
  void restart() {
    store_.reset();
    store_ = opened();
  }
  // A killed server has closed its connection without a word.
  void die() {
    server_->disconnect(name_);
    restart();
  }

 private:
  std::unique_ptr<Store> opened() const {
    return std::make_unique<Store>(std::make_unique<PostgresDatabase>(server_->url(name_)));
  }

  PostgresServer* const server_ = PostgresServer::shared();
  const std::string name_ = server_ ? server_->new_database() : "";
  std::unique_ptr<Store> store_ = server_ ? opened() : nullptr;
};

class PostgresTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresServer::missing().empty()) GTEST_SKIP() << PostgresServer::missing();
    server_ = PostgresServer::shared();
    name_ = server_->new_database();
  }
  // A test that fails while the server is down does not take the tests after it along.
  void TearDown() override {
    if (server_) server_->start();
  }
  std::string url() const { return server_->url(name_); }
  std::string why_not_opened() const {
    try {
      PostgresDatabase database(url());
    } catch (const SetupError& error) {
      return error.what();
    }
    return "opened";
  }

  PostgresServer* server_ = nullptr;
  std::string name_;
};

TEST_F(PostgresTest, AStoreGoesOnAfterItsConnectionWasEnded) {
  Store store(std::make_unique<PostgresDatabase>(url()));
  ASSERT_TRUE(store.scans.add(scan_row("a")).ok());
  server_->disconnect(name_);
  EXPECT_TRUE(store.scans.add(scan_row("b")).ok());
  server_->disconnect(name_);
  EXPECT_EQ(store.scans.list()->size(), 2u);
  server_->disconnect(name_);
  EXPECT_TRUE(store.check_writable().ok());
}

TEST_F(PostgresTest, AStoreGoesOnAfterTheServerHasCrashedAndFailsInWordsMeanwhile) {
  Store store(std::make_unique<PostgresDatabase>(url()));
  ASSERT_TRUE(store.scans.add(scan_row("a")).ok());
  server_->crash();
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 20; ++i) {
    const Status refused = store.scans.add(scan_row("b"));
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kUnavailable);
    EXPECT_THAT(refused.error().message, HasSubstr("database: "));
    EXPECT_FALSE(store.check_writable().ok());
  }
  // Refused connections and the pause of a second, but not 40 times the patience.
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
  EXPECT_EQ(store.check_integrity().error().code, ErrorCode::kIo);
  server_->start();
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // the pause before it tries again
  EXPECT_TRUE(store.scans.add(scan_row("b")).ok());
  EXPECT_EQ(store.scans.list()->size(), 2u);
}

// Loses the connection around a COMMIT, once.
class CommitLoss {
 public:
  CommitLoss(const PostgresServer& server, Fate fate)
      : proxy_(server.port(), [this, fate](std::string_view sent) {
          return sent.find("COMMIT") != std::string_view::npos && is_armed_.exchange(false)
                     ? fate
                     : Fate::kForward;
        }) {}
  void arm() { is_armed_ = true; }
  bool has_happened() const { return !is_armed_; }
  int port() const { return proxy_.port(); }

 private:
  std::atomic<bool> is_armed_ = false;
  LossyProxy proxy_;
};

TEST_F(PostgresTest, ACommitWhoseAnswerIsLostIsFoundOutToHaveSucceeded) {
  CommitLoss loss(*server_, Fate::kLoseAnswer);
  Store store(std::make_unique<PostgresDatabase>(server_->url(name_, loss.port())));
  loss.arm();
  // A second attempt would find the id taken.
  EXPECT_TRUE(store.scans.add(scan_row("a")).ok());
  EXPECT_TRUE(loss.has_happened());
  EXPECT_EQ(store.scans.list()->size(), 1u);
}

TEST_F(PostgresTest, ACommitThatWasLostOnItsWayIsDoneAgain) {
  CommitLoss loss(*server_, Fate::kLoseRequest);
  Store store(std::make_unique<PostgresDatabase>(server_->url(name_, loss.port())));
  loss.arm();
  EXPECT_TRUE(store.scans.add(scan_row("a")).ok());
  EXPECT_TRUE(loss.has_happened());
  EXPECT_EQ(store.scans.list()->size(), 1u);
}

// Every statement of a change loses its answer once: nothing is lost, and nothing is there twice.
TEST_F(PostgresTest, NoLossOfOneAnswerHarmsAChange) {
  std::atomic<int> countdown = -1;
  LossyProxy proxy(server_->port(), [&](std::string_view) {
    return countdown-- == 0 ? Fate::kLoseAnswer : Fate::kForward;
  });
  Store store(std::make_unique<PostgresDatabase>(server_->url(name_, proxy.port())));
  ASSERT_TRUE(store.scans.add(scan_row("scan")).ok());
  for (int at = 0; at < 12; ++at) {
    countdown = at;
    NoteRow note;
    note.id = "note" + std::to_string(at);
    note.scan_id = "scan";
    EXPECT_TRUE(store.notes.add(note).ok()) << at;
    countdown = -1;
    EXPECT_EQ(store.notes.of_scan("scan")->size(), static_cast<std::size_t>(at) + 1);
  }
}

// As when its disk hangs: its machine still acknowledges packets.
TEST_F(PostgresTest, AServerThatHangsIsLeftAfterABoundedTime) {
  Store store(std::make_unique<PostgresDatabase>(url(), std::chrono::milliseconds(300)));
  const SqlResult process = server_->run(name_,
                                         "SELECT pid FROM pg_stat_activity WHERE datname = "
                                         "current_database() AND pid <> pg_backend_pid() "
                                         "AND backend_type = 'client backend'");
  const auto pid = static_cast<pid_t>(RowReader(process.rows.at(0)).integer());
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(store.scans.add(scan_row("a")).error().code, ErrorCode::kUnavailable);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  // The process that hangs still has the lock.
  EXPECT_EQ(store.scans.list().error().code, ErrorCode::kUnavailable);
  ASSERT_EQ(kill(pid, SIGCONT), 0);
  const auto is_back = [&] { return store.scans.add(scan_row("b")).ok(); };
  for (int i = 0; i < 100 && !is_back(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(test::ids_of(store.scans.list()), std::vector<std::string>{"b"});
}

// A lock of another client: the server itself gives up, and the connection lasts.
TEST_F(PostgresTest, AStatementThatTakesTooLongFails) {
  Store store(std::make_unique<PostgresDatabase>(url(), std::chrono::milliseconds(300)));
  PostgresConnection other(url(), {});
  other.run_script("BEGIN; LOCK TABLE scans IN ACCESS EXCLUSIVE MODE");
  EXPECT_THAT(store.scans.add(scan_row("a")).error().message, HasSubstr("timeout"));
  other.run_script("ROLLBACK");
  EXPECT_TRUE(store.scans.add(scan_row("a")).ok());
}

TEST_F(PostgresTest, OnlyOneServerHasTheDatabase) {
  const PostgresDatabase first(url());
  EXPECT_THAT(why_not_opened(), HasSubstr("another Hermite server"));
}

// A server whose connection was lost, and whose database another one has meanwhile taken, changes
// nothing.
TEST_F(PostgresTest, AServerThatHasLostItsLockToAnotherChangesNothing) {
  Store first(std::make_unique<PostgresDatabase>(url()));
  ASSERT_TRUE(first.scans.add(scan_row("a")).ok());
  server_->disconnect(name_);
  Store second(std::make_unique<PostgresDatabase>(url()));
  EXPECT_EQ(first.scans.remove("a").error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(first.scans.label("a", {"another", std::nullopt}).error().code,
            ErrorCode::kUnavailable);
  EXPECT_EQ(second.scans.find("a")->title, scan_row("a").title);
}

TEST_F(PostgresTest, RefusesANewerSchemaAndThatOfAnotherProgram) {
  { const PostgresDatabase database(url()); }
  server_->run(name_, "UPDATE about SET version = 99");
  EXPECT_THAT(why_not_opened(), HasSubstr("schema 99"));
  server_->run(name_, "DROP TABLE about");
  EXPECT_THAT(why_not_opened(), HasSubstr("another program"));
}

TEST_F(PostgresTest, ADatabaseThatOnlyReadsIsNotWritable) {
  Store store(std::make_unique<PostgresDatabase>(url()));
  server_->run(name_, "ALTER DATABASE " + name_ + " SET default_transaction_read_only = on");
  server_->disconnect(name_);
  EXPECT_EQ(store.check_writable().error().code, ErrorCode::kIo);
  EXPECT_THAT(store.scans.add(scan_row("a")).error().message, HasSubstr("read-only"));
  EXPECT_TRUE(store.scans.list()->empty());
}

TEST_F(PostgresTest, TextsThatAreNoUtf8AreStoredReadably) {
  Store store(std::make_unique<PostgresDatabase>(url()));
  ScanRow row = scan_row("a");
  row.message = std::string("cut \xE2\x82 and \0 end", 16);
  ASSERT_TRUE(store.scans.add(row).ok());
  EXPECT_EQ(store.scans.find("a")->message, "cut \xEF\xBF\xBD\xEF\xBF\xBD and \xEF\xBF\xBD end");
  EXPECT_EQ(store.scans.find("\xFF").error().code, ErrorCode::kNotFound);
}

TEST_F(PostgresTest, NumbersComeBackWithTheSameBits) {
  Store store(std::make_unique<PostgresDatabase>(url()));
  ScanRow row = scan_row("a");
  row.camera.fx = 0.1 + 0.2;
  row.camera.fy = std::numeric_limits<double>::denorm_min();
  row.camera.cx = -std::numeric_limits<double>::max();
  row.frames_received = std::numeric_limits<std::int64_t>::max();
  ASSERT_TRUE(store.scans.add(row).ok());
  const ScanRow found = *store.scans.find("a");
  EXPECT_EQ(found.camera.fx, row.camera.fx);
  EXPECT_EQ(found.camera.fy, row.camera.fy);
  EXPECT_EQ(found.camera.cx, row.camera.cx);
  EXPECT_EQ(found.frames_received, row.frames_received);
}

TEST(PostgresUrl, WhatIsRefusedSaysWhy) {
  const auto why = [](const std::string& url, bool allow_plain = false) {
    const Status status = check_postgres_url(url, allow_plain);
    return status.ok() ? std::string("allowed") : status.error().message;
  };
  EXPECT_THAT(why("mysql://here/db"), HasSubstr("postgresql://"));
  EXPECT_THAT(why("postgresql://h/db?colour=red"), HasSubstr("colour"));
  const std::string secret = why("postgresql://me:swordfish@localhost/db");
  EXPECT_THAT(secret, HasSubstr("passfile"));
  EXPECT_EQ(secret.find("swordfish"), std::string::npos);
  EXPECT_EQ(why("postgresql:///db?password=swordfish"), secret);
  for (const char* here :
       {"postgresql:///db", "postgresql://me@localhost/db", "postgresql://127.0.0.1:5433/db",
        "postgres://[::1]/db", "postgresql:///db?host=/var/run/postgresql",
        "postgresql://far/db?sslmode=verify-full"})
    EXPECT_EQ(why(here), "allowed") << here;
  for (const char* far :
       {"postgresql://far/db", "postgresql://localhost,far/db",
        "postgresql://far/db?sslmode=require", "postgresql://localhost/db?hostaddr=10.0.0.1"}) {
    EXPECT_THAT(why(far), HasSubstr("sslmode=verify-full")) << far;
    EXPECT_EQ(why(far, true), "allowed") << far;
  }
}

}  // namespace

}  // namespace hermite::server

namespace hermite::test {
INSTANTIATE_TYPED_TEST_SUITE_P(Postgres, StoreContract, server::PostgresWorld);
}  // namespace hermite::test
