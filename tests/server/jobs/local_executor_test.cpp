#include "server/jobs/local_executor.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include <deque>
#include <map>

#include "server/store/store.h"
#include "tests/server/jobs/executor_contract.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using test::Work;

// One server after the other on one database, and work that is nothing but its end.
class LocalWorld {
 public:
  LocalWorld() { start(); }
  Executor& executor() { return *executor_; }
  LocalExecutor& local() { return *executor_; }
  Store& store() { return *store_; }

  JobRow job(Work work, int priority = 0, const std::string& token_id = "t") {
    JobRow row;
    row.token_id = token_id;
    row.id = row.source_id = new_scan_id();
    row.priority = priority;
    row.created_at_ms = ++now_ms_;
    works_[row.id] = work;
    return row;
  }
  void settle() {
    for (bool busy = true; busy;) {
      const std::size_t running = executor_->running_count();
      tick();
      busy = !posted_.empty() || executor_->running_count() != running;
      while (!posted_.empty()) {
        const std::function<void()> action = std::move(posted_.front());
        posted_.pop_front();
        action();
      }
    }
  }
  void tick() {
    executor_->tick(std::chrono::steady_clock::time_point(std::chrono::milliseconds(now_ms_)));
  }
  void die() {
    posted_.clear();
    executor_.reset();
    store_.reset();
    start();
  }
  int done_count(const std::string& id) { return done_[id]; }
  const std::vector<std::string>& started() const { return started_; }
  const std::vector<std::string>& removed_scans() const { return removed_scans_; }
  const std::vector<std::string>& ended() const { return ended_; }
  void wait(std::int64_t ms) { now_ms_ += ms; }
  // While it takes nothing, no change of a job can be stored.
  void store_takes_jobs(bool takes) {
    SQLite::Database(folder_ / "db", SQLite::OPEN_READWRITE)
        .exec(takes ? "DROP TRIGGER full"
                    : "CREATE TRIGGER full BEFORE UPDATE ON jobs BEGIN SELECT RAISE(FAIL, 'no "
                      "room'); END");
  }
  std::set<std::string> finished_scans, elsewhere, refused;  // the latter by the id of the job
  bool has_room = false;

 private:
  class Piece : public JobWork {
   public:
    Piece(LocalWorld& world, JobRow row, JobEvents events)
        : world_(world), row_(std::move(row)), events_(std::move(events)) {
      events_.log("working");
      const Work work = world_.works_.at(row_.id);
      if (work == Work::kGoesOn) return;
      world_.posted_.push_back([this, work] {
        if (work == Work::kLacksRoom && !world_.has_room)
          return events_.ended({JobState::kQueued, "the disk is full", true});
        ++world_.done_[row_.id];
        events_.ended(work == Work::kFails ? JobEnd{JobState::kFailed, "it was to fail"}
                                           : JobEnd{JobState::kFinished, ""});
      });
    }
    void cancel() override {
      if (world_.works_.at(row_.id) != Work::kGoesOn) return;
      world_.posted_.push_back([this] { events_.ended({JobState::kCancelled, ""}); });
    }
    void stop() override {
      world_.posted_.push_back([this] { events_.ended({JobState::kQueued, ""}); });
    }
    void tick() override {}

   private:
    LocalWorld& world_;
    const JobRow row_;
    const JobEvents events_;
  };

  void start() {
    store_ = std::make_unique<Store>(folder_ / "db");
    const JobScans scans{[this](const std::string& id) { return finished_scans.contains(id); },
                         [this](const std::string& id) { removed_scans_.push_back(id); },
                         [this](const JobRow& row) { return elsewhere.contains(row.id); }};
    ASSERT_TRUE(recover_jobs(*store_, scans, ++now_ms_).ok());
    LocalExecutor::Hooks hooks;
    hooks.start = [this](const JobRow& row, JobEvents events) {
      started_.push_back(row.id);
      return std::make_unique<Piece>(*this, row, std::move(events));
    };
    hooks.ended = [this](const JobRow& row) { ended_.push_back(row.id); };
    hooks.now_ms = [this] { return ++now_ms_; };
    hooks.new_scan_id = new_scan_id;
    hooks.post = [this](std::function<void()> action) { posted_.push_back(std::move(action)); };
    hooks.has_room = [this](const JobRow& row) { return !refused.contains(row.id); };
    executor_ = std::make_unique<LocalExecutor>(2, *store_, hooks);
  }

  const test::TemporaryFolder folder_;
  std::int64_t now_ms_ = kForgetJobsAfter_ms;
  std::map<std::string, Work> works_;
  std::map<std::string, int> done_;
  std::vector<std::string> started_, removed_scans_, ended_;
  std::deque<std::function<void()>> posted_;
  std::unique_ptr<Store> store_;
  std::unique_ptr<LocalExecutor> executor_;
};

class LocalExecutorTest : public testing::Test {
 protected:
  std::string submit(Work work, int priority = 0) {
    const JobRow job = world_.job(work, priority);
    EXPECT_TRUE(world_.executor().submit(job).ok());
    return job.id;
  }
  LocalWorld world_;
};

TEST(LocalExecutor, TokensTakeTurnsHoweverManyOneHasSubmitted) {
  LocalWorld world;
  const auto submit = [&world](const std::string& token, int priority = 0) {
    const JobRow row = world.job(Work::kFinishes, priority, token);
    EXPECT_TRUE(world.executor().submit(row).ok());
    return row.id;
  };
  const std::string many1 = submit("many"), many2 = submit("many"), many3 = submit("many"),
                    urgent = submit("many", 1), one1 = submit("one"), one2 = submit("one");
  world.settle();
  EXPECT_THAT(world.started(), testing::ElementsAre(urgent, one1, many1, one2, many2, many3));
}

TEST_F(LocalExecutorTest, SoManyRunAtOnceTheHighestPriorityFirst) {
  const std::string low = submit(Work::kGoesOn, -1), middle = submit(Work::kGoesOn),
                    high = submit(Work::kGoesOn, 10);
  world_.settle();
  EXPECT_EQ(world_.local().running_count(), 2u);
  EXPECT_THAT(world_.started(), testing::ElementsAre(high, middle));
  ASSERT_TRUE(world_.executor().cancel(high).ok());
  world_.settle();
  EXPECT_THAT(world_.started(), testing::ElementsAre(high, middle, low));
}

TEST_F(LocalExecutorTest, AJobWhoseScanWasFinishedWhenTheServerDiedIsNotDoneAgain) {
  const std::string id = submit(Work::kGoesOn);
  world_.settle();
  const std::string scan = world_.executor().status(id)->row.scan_id;
  EXPECT_TRUE(is_scan_id(scan)) << "chosen, and on disk, before the work begins";
  world_.finished_scans.insert(scan);
  world_.die();
  world_.settle();
  EXPECT_EQ(world_.executor().status(id)->row.state, JobState::kFinished);
  EXPECT_EQ(world_.started().size(), 1u);
}

TEST_F(LocalExecutorTest, AJobThatOtherMachinesDoIsNoAttemptHoweverOftenTheServerDies) {
  const std::string id = submit(Work::kGoesOn);
  world_.elsewhere.insert(id);
  for (int i = 0; i < 2 * kMaxAttempts; ++i) {
    world_.settle();
    world_.die();
  }
  world_.settle();
  EXPECT_EQ(world_.executor().status(id)->row.state, JobState::kRunning);
  EXPECT_EQ(world_.executor().status(id)->row.attempt_count, 1);
}

TEST_F(LocalExecutorTest, OneThatHasNoRoomDoesNotHoldUpThoseBehindIt) {
  const std::string first = submit(Work::kGoesOn, 10), second = submit(Work::kFinishes);
  world_.refused.insert(first);
  world_.settle();
  EXPECT_EQ(world_.executor().status(first)->row.state, JobState::kQueued);
  EXPECT_EQ(world_.executor().status(second)->row.state, JobState::kFinished);
  world_.refused.clear();
  world_.settle();
  EXPECT_EQ(world_.executor().status(first)->row.state, JobState::kRunning);
  EXPECT_EQ(world_.local().count_running([&](const JobRow& row) { return row.id == first; }), 1u);
}

TEST_F(LocalExecutorTest, AJobGoesOnWithItsScan) {
  const std::string id = submit(Work::kGoesOn);
  world_.settle();
  const std::string scan = world_.executor().status(id)->row.scan_id;
  world_.die();
  world_.settle();
  EXPECT_EQ(world_.executor().status(id)->row.scan_id, scan);
  EXPECT_EQ(world_.executor().status(id)->row.attempt_count, 2);
  EXPECT_THAT(world_.removed_scans(), testing::IsEmpty());
}

TEST_F(LocalExecutorTest, TheScanOfAJobThatWasCancelledWhenTheServerDiedGoes) {
  const std::string id = submit(Work::kGoesOn);
  world_.settle();
  const std::string scan = world_.executor().status(id)->row.scan_id;
  ASSERT_TRUE(world_.executor().cancel(id).ok());
  world_.die();
  EXPECT_THAT(world_.removed_scans(), testing::ElementsAre(scan));
}

TEST_F(LocalExecutorTest, StoppingIsNoAttemptAndNobodysEnd) {
  const std::string id = submit(Work::kGoesOn);
  world_.settle();
  world_.local().stop();
  world_.settle();
  EXPECT_EQ(world_.executor().status(id)->row.state, JobState::kQueued);
  EXPECT_EQ(world_.executor().status(id)->row.attempt_count, 0);
  EXPECT_THAT(world_.ended(), testing::IsEmpty());
  EXPECT_EQ(world_.started().size(), 1u) << "nothing is started any more";
  world_.die();
  world_.settle();
  EXPECT_EQ(world_.executor().status(id)->row.state, JobState::kRunning);
}

TEST_F(LocalExecutorTest, OneThatTheDiskHadNoRoomForIsTriedAgainLaterAndLater) {
  const std::string id = submit(Work::kLacksRoom);
  world_.settle();
  EXPECT_EQ(world_.executor().status(id)->row.state, JobState::kQueued);
  EXPECT_EQ(world_.executor().status(id)->row.message, "the disk is full");
  for (const std::int64_t pause_ms : {kFirstRoomPause_ms, 2 * kFirstRoomPause_ms}) {
    const std::size_t starts = world_.started().size();
    world_.wait(pause_ms - 1000);
    world_.settle();
    EXPECT_EQ(world_.started().size(), starts) << pause_ms;
    world_.wait(1000);
    world_.settle();
    EXPECT_EQ(world_.started().size(), starts + 1);
  }
  EXPECT_EQ(world_.executor().status(id)->row.attempt_count, 0) << "it is not the job's fault";
  EXPECT_THAT(world_.ended(), testing::IsEmpty());
  world_.has_room = true;
  world_.wait(4 * kFirstRoomPause_ms);
  world_.settle();
  EXPECT_EQ(world_.executor().status(id)->row.state, JobState::kFinished);
  EXPECT_EQ(world_.done_count(id), 1);
}

TEST_F(LocalExecutorTest, AnEndThatCannotBeStoredIsToldAndStoredLater) {
  const std::string done = submit(Work::kFinishes), lacks = submit(Work::kLacksRoom);
  world_.tick();
  world_.store_takes_jobs(false);
  world_.settle();
  EXPECT_EQ(world_.store().jobs.find(done)->state, JobState::kRunning);
  EXPECT_EQ(world_.executor().status(done)->row.state, JobState::kFinished);
  EXPECT_EQ(world_.executor().status(lacks)->row.state, JobState::kQueued);
  const std::vector<JobStatus> listed = *world_.executor().list();
  for (const JobStatus& job : listed) EXPECT_NE(job.row.state, JobState::kRunning);
  world_.store_takes_jobs(true);
  world_.has_room = true;
  world_.wait(kFirstRoomPause_ms);
  world_.settle();
  EXPECT_EQ(world_.store().jobs.find(done)->state, JobState::kFinished);
  EXPECT_EQ(world_.store().jobs.find(lacks)->state, JobState::kFinished);
  EXPECT_EQ(world_.done_count(done), 1);
}

TEST_F(LocalExecutorTest, ACancelledOneIsNotTriedAgainBeforeItIsOver) {
  const JobRow job = world_.job(Work::kGoesOn);
  ASSERT_TRUE(world_.executor().submit(job).ok());
  world_.settle();
  ASSERT_TRUE(world_.executor().cancel(job.id).ok());
  EXPECT_EQ(world_.executor().submit(job).error().code, ErrorCode::kBusy);
  world_.settle();
  EXPECT_TRUE(world_.executor().submit(job).ok());
  EXPECT_THAT(world_.ended(), testing::ElementsAre(job.id));
}

}  // namespace

}  // namespace hermite::server

namespace hermite::test {
INSTANTIATE_TYPED_TEST_SUITE_P(Local, ExecutorContract, server::LocalWorld);
}  // namespace hermite::test
