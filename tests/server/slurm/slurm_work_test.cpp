// What the server does with answers of Slurm that a test cluster does not give: programs that only
// look like Slurm's. tests/faults/slurm_jobs.py has the real ones.
#include "server/slurm/slurm_work.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/dataset/text_file.h"
#include "core/dataset/write_raw.h"
#include "core/source/open_sequence.h"
#include "server/client/api_request.h"
#include "server/client/upload.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server::slurm_work_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

// The state of all jobs is in a file; what was submitted and cancelled is written down.
constexpr const char* kSbatch = R"(echo "$@" >>submitted
[ -e refuses ] && { echo 'sbatch: error: the controller is away' >&2; exit 1; }
for word; do case $word in --job-name=*) echo "${word#--job-name=}" >>names;; esac; done
[ -e answers-late ] && { echo 'sbatch: error: Socket timed out' >&2; exit 1; }
wc -l <names)";
constexpr const char* kSqueue = R"([ -e state ] || exit 0
number=0
while read -r name; do
  number=$((number + 1))
  echo "$number|$name|$(cat state)|0|1:0|node1|None|"
done <names)";
constexpr const char* kScancel = R"(echo "$@" >>cancelled)";

class SlurmWorkTest : public testing::Test {
 protected:
  SlurmWorkTest() : path_before_(std::getenv("PATH")) {
    fs::create_directory(folder_ / "bin");
    program("sbatch", kSbatch);
    program("squeue", kSqueue);
    program("scancel", kScancel);
    setenv("PATH", ((folder_ / "bin") + ":" + path_before_).c_str(), 1);
    start();
  }
  ~SlurmWorkTest() override {
    server_.reset();
    setenv("PATH", path_before_.c_str(), 1);
  }
  void start() {
    server_.reset();
    ServiceOptions options = test::test_options(folder_ / "data");
    options.drain_s = 0;
    options.batch = "slurm";
    options.slurm_program = "hermite";
    options.slurm_poll_ms = 50;
    options.slurm_memory_mb = 1000;
    server_ = std::make_unique<test::RunningServer>(options);
  }
  void program(const std::string& name, const std::string& text) {
    const std::string path = folder_ / ("bin/" + name);
    std::ofstream(path) << "#!/bin/sh\ncd '" << folder_.path() << "' && touch names\n"
                        << text << "\n";
    fs::permissions(path, fs::perms::owner_all);
  }
  void write(const std::string& name, const std::string& text) {
    const std::string path = folder_ / name;
    { std::ofstream(path + ".new") << text << "\n"; }
    fs::rename(path + ".new", path);
  }
  std::string read(const std::string& name) {
    const Result<std::string> text = dataset::read_text_file(folder_ / name);
    return text.ok() ? *text : "";
  }
  std::size_t lines_of(const std::string& name) {
    const std::string text = read(name);
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }
  std::string submit() {
    const std::string path = folder_ / "room.raw";
    const auto room = *source::open_sequence("synthetic:width=160,height=120,frames=2");
    EXPECT_TRUE(dataset::write_raw(*room, {0, 2}, path, [](std::int64_t) {}).ok());
    return *client::upload(*client::open_bytes(path), {}, target(), {});
  }
  client::UploadTarget target() const {
    client::UploadTarget target;
    target.server = {"127.0.0.1", static_cast<std::uint16_t>(server_->port()), server_->token(),
                     false};
    return target;
  }
  json job(const std::string& id) {
    return json::parse(*client::api_request(target().server, "GET", "/api/v1/jobs/" + id, ""));
  }
  bool comes_to(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  json end_of(const std::string& id) {
    json last;
    EXPECT_TRUE(comes_to([&] {
      last = job(id);
      return last["state"] != "running" && last["state"] != "queued";
    }));
    return last;
  }

  const std::string path_before_;
  const test::TemporaryFolder folder_;
  std::unique_ptr<test::RunningServer> server_;
};

TEST_F(SlurmWorkTest, AfterThreeTimeLimitsTheJobSaysSo) {
  write("state", "TIMEOUT");
  const json ended = end_of(submit());
  EXPECT_EQ(ended["state"], "failed");
  EXPECT_THAT(std::string(ended["words"]),
              testing::AllOf(HasSubstr("time limit"), HasSubstr("3 times")));
  EXPECT_EQ(lines_of("submitted"), 3u);
  EXPECT_TRUE(comes_to([this] { return fs::is_empty(folder_ / "data/slurm"); }))
      << "what was exchanged goes";
}

TEST_F(SlurmWorkTest, WhatLackedMemoryAsksForTwiceAsMuch) {
  write("state", "OUT_OF_MEMORY");
  EXPECT_THAT(std::string(end_of(submit())["words"]), HasSubstr("more memory"));
  const std::string submitted = read("submitted");
  for (const char* request : {"--mem=1000 ", "--mem=2000 ", "--mem=4000 "})
    EXPECT_THAT(submitted, HasSubstr(request));
}

TEST_F(SlurmWorkTest, OneThatSlurmDoesNotKnowIsSubmittedAgain) {
  EXPECT_THAT(std::string(end_of(submit())["words"]), HasSubstr("does not know the job"));
  EXPECT_EQ(lines_of("submitted"), 3u);
}

TEST_F(SlurmWorkTest, OneThatWasCancelledInSlurmIsNotTriedAgainByItself) {
  write("state", "CANCELLED");
  EXPECT_THAT(std::string(end_of(submit())["words"]), HasSubstr("scancel"));
  EXPECT_EQ(lines_of("submitted"), 1u);
}

TEST_F(SlurmWorkTest, AnAnswerThatCameTooLateIsNoSecondSubmission) {
  write("answers-late", "");
  write("state", "RUNNING");
  const std::string id = submit();
  EXPECT_TRUE(comes_to([&] { return job(id)["stage"] == "waiting for the cluster"; }));
  EXPECT_THAT(job(id).dump(), HasSubstr("Socket timed out"));
  EXPECT_TRUE(comes_to([&] { return job(id)["stage"] == "starting"; })) << "it was found";
  EXPECT_EQ(lines_of("submitted"), 1u);
}

TEST_F(SlurmWorkTest, TheNextServerSubmitsNothingAgainAndACancelledJobLeavesSlurm) {
  write("state", "PENDING");
  const std::string id = submit();
  EXPECT_TRUE(comes_to([&] { return job(id)["stage"] == "waiting in the cluster"; }));
  start();
  EXPECT_TRUE(comes_to([&] { return job(id)["stage"] == "waiting in the cluster"; }));
  EXPECT_EQ(lines_of("submitted"), 1u);
  EXPECT_EQ(job(id)["attempts"], 1);
  ASSERT_TRUE(client::change_job(target(), id, false).ok());
  EXPECT_EQ(job(id)["state"], "cancelled");
  EXPECT_TRUE(comes_to([this] { return lines_of("cancelled") > 0; }));
  EXPECT_THAT(read("cancelled"), HasSubstr("hermite-" + id + "-1-"));
  EXPECT_TRUE(comes_to([this] { return fs::is_empty(folder_ / "data/slurm"); }));
}

TEST(SlurmCluster, TheFolderOfAnotherServerIsRefused) {
  const test::TemporaryFolder folder;
  SlurmOptions options;
  options.folder = folder / "shared";
  options.owner = "one:/data";
  { const SlurmCluster cluster(options, {}); }
  { const SlurmCluster cluster(options, {}); }
  options.owner = "two:/data";
  try {
    const SlurmCluster cluster(options, {});
    ADD_FAILURE() << "both would dismiss each other's jobs";
  } catch (const SetupError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("one:/data"), HasSubstr("two:/data")));
  }
}

TEST(SlurmCluster, JobsAskForWhatEarlierOnesHaveTaken) {
  const test::TemporaryFolder folder;
  SlurmOptions options;
  options.folder = folder / "shared";
  SlurmCluster cluster(options, {});
  EXPECT_EQ(cluster.memory_request_mb(), kFirstMemory_mb);
  cluster.memory_taken(2'000'000'000);
  EXPECT_EQ(cluster.memory_request_mb(), 3000);
  cluster.memory_taken(4'000'000'000);
  EXPECT_EQ(cluster.memory_request_mb(), 3750);
  for (int i = 0; i < 50; ++i) cluster.memory_taken(1'000'000);
  EXPECT_EQ(cluster.memory_request_mb(), kLeastMemory_mb);
}

}  // namespace
}  // namespace hermite::server::slurm_work_test
