// What is acknowledged is there, whichever call a disk says no to: every write, sync, rename, cut
// and new folder of the frame log, the results, the uploads, the database and the backup fails
// once, with "no space left", "input/output error" and "quota exceeded" (the last three only with
// the first), alone and with all that follow. Afterwards everything is opened again on a disk that
// is well. A change of the database whose sync has failed may be there all the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <functional>
#include <map>
#include <vector>

#include "core/digest/sha256.h"
#include "core/log/frame_log.h"
#include "server/store/backup.h"
#include "server/store/data_directory.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "server/store/upload_file.h"
#include "tests/every_call/failing_disk.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

using test::FailingDisk;

const std::vector<int> kErrors = {ENOSPC, EIO, EDQUOT};
constexpr int kFarTooMany = 2000;

// Calls `work` with an armed disk for each of its calls, each error, alone and with all that
// follow, and `look` afterwards. `prepare` comes before, on a disk that is well. Each in a folder
// of its own.
struct Trial {
  std::function<void(const std::string& folder)> prepare = [](const std::string&) {};
  std::function<void(const std::string& folder)> work;
  std::function<void(const std::string& folder)> look;
};

int at_every_call(const Trial& trial) {
  int points = 0;
  std::map<std::string, int> calls;
  for (const int error : kErrors)
    for (const bool stays : {false, true})
      for (int number = 0; number < kFarTooMany; ++number) {
        const test::TemporaryFolder folder;
        trial.prepare(folder.path());
        std::string failed;
        {
          const FailingDisk disk(number, error, stays);
          trial.work(folder.path());
          failed = disk.failed_call();
        }
        SCOPED_TRACE(failed + " " + std::to_string(number) + ", error " + std::to_string(error) +
                     (stays ? ", and all that follow" : ""));
        trial.look(folder.path());
        if (failed.empty()) break;
        ++points;
        ++calls[failed];
        if (testing::Test::HasFailure()) return points;
      }
  std::string text;
  for (const auto& [call, count] : calls) text += " " + call + " " + std::to_string(count);
  testing::Test::RecordProperty("points", points);
  std::printf("%d points:%s\n", points, text.c_str());
  EXPECT_GT(points, 6);
  return points;
}

TEST(EveryCall, FramesThatWereSaidToBeDurableAreInTheLog) {
  constexpr int kFrames = 6;
  static std::atomic<std::uint64_t> durable;
  Trial trial;
  trial.prepare = [](const std::string& folder) {
    std::filesystem::create_directory(folder + "/scan");
  };
  const auto payload = [](int i) { return std::string(200, static_cast<char>('a' + i)); };
  trial.work = [&payload](const std::string& folder) {
    durable = 0;
    frame_log::FrameLogOptions options;
    options.segment_bytes = 600;
    options.group_bytes = 300;
    options.group_time = std::chrono::milliseconds(1);
    const frame_log::FrameLogEvents events{[](std::uint64_t count) { durable = count; },
                                           [](const Error&) {}};
    auto log = frame_log::FrameLog::create(folder + "/scan/log", "terms", "start", events, options);
    for (int i = 0; log.ok() && i < kFrames; ++i)
      (*log)->append(frame_log::RecordType::kFrame, payload(i)).ok();
  };
  trial.look = [&payload](const std::string& folder) {
    Result<frame_log::FrameLog::Opened> opened = frame_log::FrameLog::open(
        folder + "/scan/log", {[](std::uint64_t) {}, [](const Error&) {}});
    if (durable > 0) {
      ASSERT_TRUE(opened.ok()) << opened.error().message;
    }
    if (!opened.ok()) return;
    EXPECT_GE(opened->contents.frame_count, durable.load());
    opened->log->append(frame_log::RecordType::kFrame, payload(9)).ok();
    opened->log.reset();
    frame_log::FrameLogReader reader(folder + "/scan/log");
    for (std::uint64_t i = 0; i < opened->contents.frame_count + 2; ++i) {
      const auto record = reader.next();
      ASSERT_TRUE(record.ok() && *record);
      if (i >= 2) {
        EXPECT_EQ((*record)->payload, payload(static_cast<int>(i) - 2));
      }
    }
    EXPECT_TRUE(*reader.next()) << "what was appended on a disk that is well";
  };
  at_every_call(trial);
}

TEST(EveryCall, AResultIsTheOldOneOrTheNewOne) {
  static bool stored;
  const std::string id = server::new_scan_id();
  Trial trial;
  trial.prepare = [&id](const std::string& folder) {
    ASSERT_TRUE(server::FileBlobs(folder).put(id, "report.json", "old").ok());
  };
  trial.work = [&id](const std::string& folder) {
    server::FileBlobs blobs(folder);
    stored = blobs.put(id, "report.json", std::string(100'000, 'n')).ok();
    blobs.put(server::new_scan_id(), "cloud.ply", "x").ok();
  };
  trial.look = [&id](const std::string& folder) {
    const Result<std::string> found = server::FileBlobs(folder).read(id, "report.json", 0, 200'000);
    ASSERT_TRUE(found.ok());
    EXPECT_TRUE(*found == std::string(100'000, 'n') || (!stored && *found == "old"));
  };
  at_every_call(trial);
}

TEST(EveryCall, BytesOfAnUploadThatWereSyncedAreThere) {
  static std::int64_t synced;
  Trial trial;
  trial.work = [](const std::string& folder) {
    synced = 0;
    Result<server::UploadFile> file = server::UploadFile::create(folder + "/upload");
    for (int i = 0; file.ok() && i < 4; ++i) {
      if (!file->append(std::string(1000, static_cast<char>('a' + i))).ok()) break;
      if (file->sync().ok()) synced = file->size_bytes();
    }
    if (file.ok() && file->size_bytes() >= 500 && file->cut(500).ok()) synced = 500;
  };
  trial.look = [](const std::string& folder) {
    const Result<std::int64_t> size = server::upload_size_bytes(folder + "/upload");
    if (size.ok() || synced > 0) {
      EXPECT_GE(*size, std::min<std::int64_t>(synced, 500));
    }
  };
  at_every_call(trial);
}

server::ScanRow scan_row(const std::string& id) {
  server::ScanRow row;
  row.id = id;
  row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
  return row;
}

TEST(EveryCall, RowsThatWereStoredAreInTheDatabase) {
  static std::map<std::string, bool> stored;
  Trial trial;
  trial.prepare = [](const std::string& folder) {
    server::Store store(folder + "/db");
    ASSERT_TRUE(store.scans.add(scan_row("before")).ok());
  };
  trial.work = [](const std::string& folder) {
    stored.clear();
    try {
      server::Store store(folder + "/db");
      stored["scan"] = store.scans.add(scan_row("scan")).ok();
      server::ScanRow ended = scan_row("before");
      ended.phase = server::ScanPhase::kFinished;
      stored["end"] = store.scans.update(ended).ok();
      server::TokenRow token;
      token.id = "token";
      token.secret_sha256 = digest::sha256("x");
      stored["token"] = store.tokens.add(token).ok();
      stored["upload"] = store.uploads.add({"upload", "token", 1, "", -1, 0, 0}).ok();
      const bool there = store.uploads.add({"to go", "token", 1, "", -1, 0, 0}).ok();
      server::JobRow job;
      job.id = "job";
      stored["job"] = store.jobs.add(job).ok();
      stored["removed"] = there && store.uploads.remove("to go").ok();
    } catch (const SetupError&) {
    }
  };
  trial.look = [](const std::string& folder) {
    server::Store store(folder + "/db");
    EXPECT_TRUE(store.check_integrity().ok());
    ASSERT_TRUE(store.scans.find("before").ok());
    if (stored["scan"]) {
      EXPECT_TRUE(store.scans.find("scan").ok());
    }
    if (stored["end"]) {
      EXPECT_EQ(store.scans.find("before")->phase, server::ScanPhase::kFinished);
    }
    if (stored["token"]) {
      EXPECT_TRUE(store.tokens.find("token").ok());
    }
    if (stored["job"]) {
      EXPECT_TRUE(store.jobs.find("job").ok());
    }
    if (stored["upload"]) {
      EXPECT_TRUE(store.uploads.find("upload").ok());
    }
    if (stored["removed"]) {
      EXPECT_FALSE(store.uploads.find("to go").ok());
    }
    EXPECT_TRUE(store.scans.add(scan_row("afterwards")).ok());
  };
  at_every_call(trial);
}

TEST(EveryCall, ABackupIsWholeOrNotThere) {
  static bool backed_up;
  const std::string id = server::new_scan_id();
  Trial trial;
  trial.prepare = [&id](const std::string& folder) {
    const server::DataDirectory data(folder + "/data");
    server::Store store(data.database_path());
    ASSERT_TRUE(store.scans.add(scan_row(id)).ok());
    ASSERT_TRUE(server::FileBlobs(data.scans_folder()).put(id, "report.json", "report").ok());
  };
  trial.work = [](const std::string& folder) {
    backed_up = server::back_up(folder + "/data", folder + "/backup").ok();
  };
  trial.look = [&id](const std::string& folder) {
    EXPECT_EQ(std::filesystem::exists(folder + "/backup"), backed_up);
    if (!backed_up) return;
    ASSERT_TRUE(server::restore(folder + "/backup", folder + "/restored").ok());
    EXPECT_EQ(*server::FileBlobs(folder + "/restored/scans").read(id, "report.json", 0, 100),
              "report");
    EXPECT_TRUE(server::Store(folder + "/restored/hermite.db").scans.find(id).ok());
  };
  at_every_call(trial);
}

TEST(EveryCall, ARestoreIsWholeOrNothing) {
  static bool restored;
  const std::string id = server::new_scan_id();
  Trial trial;
  trial.prepare = [&id](const std::string& folder) {
    {
      const server::DataDirectory data(folder + "/data");
      server::Store store(data.database_path());
      ASSERT_TRUE(store.scans.add(scan_row(id)).ok());
      ASSERT_TRUE(server::FileBlobs(data.scans_folder()).put(id, "report.json", "report").ok());
    }
    ASSERT_TRUE(server::back_up(folder + "/data", folder + "/backup").ok());
  };
  trial.work = [](const std::string& folder) {
    restored = server::restore(folder + "/backup", folder + "/restored").ok();
  };
  trial.look = [&id](const std::string& folder) {
    const bool there = std::filesystem::exists(folder + "/restored/hermite.db");
    EXPECT_EQ(there, restored);
    if (!restored) return;
    EXPECT_EQ(*server::FileBlobs(folder + "/restored/scans").read(id, "report.json", 0, 100),
              "report");
    EXPECT_TRUE(server::Store(folder + "/restored/hermite.db").scans.find(id).ok());
  };
  at_every_call(trial);
}

TEST(EveryCall, ADataFolderIsMadeOrSaysWhyNot) {
  Trial trial;
  trial.work = [](const std::string& folder) {
    try {
      const server::DataDirectory data(folder + "/data");
    } catch (const SetupError&) {
    }
  };
  trial.look = [](const std::string& folder) {
    const server::DataDirectory data(folder + "/data");
    EXPECT_EQ(data.token().size(), 64u);
  };
  at_every_call(trial);
}

}  // namespace
}  // namespace hermite
