// What was acknowledged is there after a power cut, at whatever call of the frame log, the results,
// the uploads, the database, the backup, the restore, the audit log and the data folder it comes:
// everything is opened again from each of the images of power_cut.h by the code that opens it in
// the server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "core/digest/sha256.h"
#include "core/log/frame_log.h"
#include "server/access/audit.h"
#include "server/store/backup.h"
#include "server/store/data_directory.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "server/uploads/uploads.h"
#include "tests/every_call/power_cut.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

namespace fs = std::filesystem;
using test::Acknowledged;
using test::DiskImage;
using test::PowerCut;

constexpr std::int64_t kNow_ms = 1'000'000'000'000;

struct CutTrial {
  // Prepares the folder, all of which is then synced.
  std::function<void(const std::string& folder)> prepare = [](const std::string&) {};
  std::function<void(const std::string& folder, PowerCut& power)> work;
  std::function<void(const std::string& folder, const Acknowledged& acknowledged)> look;
};

void cut_at_every_call(const CutTrial& trial) {
  std::vector<DiskImage> images;
  int calls = 0;
  {
    const test::TemporaryFolder folder;
    trial.prepare(folder.path());
    PowerCut power(folder.path());
    trial.work(folder.path(), power);
    images = power.end();
    calls = power.call_count();
  }
  std::printf("%d calls, %zu disks that differ\n", calls, images.size());
  EXPECT_GT(images.size(), 6u);
  for (const DiskImage& image : images) {
    SCOPED_TRACE(image.when);
    const test::TemporaryFolder folder;
    image.restore_into(folder.path());
    trial.look(folder.path(), image.acknowledged);
    if (testing::Test::HasFailure()) return;
  }
}

std::string payload(std::int64_t number) {
  return std::string(200, static_cast<char>('a' + number));
}

// A log of two lives, as Scans begins and goes on with it.
TEST(PowerCut, FramesThatWereSaidToBeDurableAreInTheLog) {
  constexpr int kFrames = 6;
  const std::string id = server::new_scan_id();
  frame_log::FrameLogOptions options;
  options.segment_bytes = 600;
  options.group_bytes = 300;
  options.group_time = std::chrono::milliseconds(1);
  CutTrial trial;
  trial.prepare = [](const std::string& folder) { const server::DataDirectory data(folder); };
  trial.work = [&](const std::string& folder, PowerCut& power) {
    const server::DataDirectory data(folder);
    ASSERT_TRUE(data.create_scan_folder(id).ok());
    const frame_log::FrameLogEvents events{[&power](std::uint64_t count) {
                                             power.acknowledge("frames",
                                                               static_cast<std::int64_t>(count));
                                           },
                                           [](const Error&) {}};
    {
      auto log =
          frame_log::FrameLog::create(data.log_folder(id), "terms", "start", events, options);
      ASSERT_TRUE(log.ok());
      power.acknowledge("begun");
      for (int i = 0; i < kFrames / 2; ++i)
        ASSERT_TRUE((*log)->append(frame_log::RecordType::kFrame, payload(i)).ok());
    }
    auto again = frame_log::FrameLog::open(data.log_folder(id), events, options);
    ASSERT_TRUE(again.ok());
    for (int i = kFrames / 2; i < kFrames; ++i)
      ASSERT_TRUE(again->log->append(frame_log::RecordType::kFrame, payload(i)).ok());
  };
  trial.look = [&](const std::string& folder, const Acknowledged& acknowledged) {
    const server::DataDirectory data(folder);
    Result<frame_log::FrameLog::Opened> opened = frame_log::FrameLog::open(
        data.log_folder(id), {[](std::uint64_t) {}, [](const Error&) {}}, options);
    if (acknowledged.contains("begun")) {
      ASSERT_TRUE(opened.ok()) << opened.error().message;
    }
    if (!opened.ok()) return;
    const auto durable = acknowledged.find("frames");
    const auto frames = static_cast<std::int64_t>(opened->contents.frame_count);
    EXPECT_GE(frames, durable == acknowledged.end() ? 0 : durable->second);
    ASSERT_TRUE(opened->log->append(frame_log::RecordType::kFrame, payload(9)).ok());
    opened->log.reset();
    frame_log::FrameLogReader reader(data.log_folder(id));
    for (std::int64_t i = -2; i <= frames; ++i) {
      const auto record = reader.next();
      ASSERT_TRUE(record.ok() && *record) << i;
      if (i >= 0) {
        EXPECT_EQ((*record)->payload, payload(i == frames ? 9 : i));
      }
    }
    EXPECT_FALSE(*reader.next());
  };
  cut_at_every_call(trial);
}

TEST(PowerCut, AResultIsTheOldOneOrTheNewOne) {
  const std::string id = server::new_scan_id(), imported = server::new_scan_id();
  const std::string bytes(10'000, 'n');
  CutTrial trial;
  trial.prepare = [&](const std::string& folder) {
    ASSERT_TRUE(server::FileBlobs(folder).put(id, "report.json", "old").ok());
  };
  trial.work = [&](const std::string& folder, PowerCut& power) {
    server::FileBlobs blobs(folder);
    ASSERT_TRUE(blobs.put(id, "report.json", bytes).ok());
    power.acknowledge("replaced");
    ASSERT_TRUE(blobs.put(imported, "cloud.ply", bytes).ok());
    power.acknowledge("new");
    ASSERT_TRUE(blobs.put(imported, "report.json", bytes).ok());
    power.acknowledge("second");
  };
  trial.look = [&](const std::string& folder, const Acknowledged& acknowledged) {
    server::FileBlobs blobs(folder);
    const auto read = [&](const std::string& scan, const std::string& name) {
      const Result<std::string> found = blobs.read(scan, name, 0, 2 * bytes.size());
      return found.ok() ? *found : "none";
    };
    const auto expect = [&](const std::string& what, const std::string& found,
                            const std::string& before) {
      EXPECT_TRUE(found == bytes || (found == before && !acknowledged.contains(what)))
          << what << ": " << found.substr(0, 20);
    };
    expect("replaced", read(id, "report.json"), "old");
    expect("new", read(imported, "cloud.ply"), "none");
    expect("second", read(imported, "report.json"), "none");
  };
  cut_at_every_call(trial);
}

// The part of a server that takes uploads.
struct UploadServer {
  explicit UploadServer(const std::string& folder)
      : data(folder),
        store(data.database_path()),
        blobs(data.scans_folder()),
        waste(data.set_aside(), now),
        quota(0, [this] { return data.scan_sizes(); }, {now, now}),
        uploads({100'000, 0, 0, server::kDay_ms}, server::Storage{data, store, blobs, waste, quota},
                [this](const server::UploadRow& row) {
                  server::JobRow job;
                  job.id = row.id;
                  return store.jobs.find(row.id).ok() ? Status(Done{}) : store.jobs.add(job);
                }) {}

  const server::Waste::Post now = [](const std::function<void()>& action) { action(); };
  const server::DataDirectory data;
  server::Store store;
  server::FileBlobs blobs;
  server::Waste waste;
  server::StorageQuota quota;
  server::Uploads uploads;
};

const server::Grant kSender{"token", {true, true, false}, "", 0};

Result<server::UploadState> send(server::Uploads& uploads, const server::UploadState& state,
                                 const std::string& bytes) {
  Result<std::shared_ptr<server::UploadWriter>> writer = uploads.write(
      state, {state.offset_bytes, static_cast<std::int64_t>(bytes.size()), std::nullopt}, kSender);
  if (!writer.ok()) return writer.error();
  if (Status status = (*writer)->write(bytes); !status.ok()) return status.error();
  if (Status status = (*writer)->close(true); !status.ok()) return status.error();
  return uploads.written(state, **writer, kNow_ms);
}

TEST(PowerCut, BytesOfAnUploadThatWereAcknowledgedAreThere) {
  static std::string id, removed;  // of the first run
  CutTrial trial;
  trial.prepare = [](const std::string& folder) { const UploadServer server(folder); };
  trial.work = [](const std::string& folder, PowerCut& power) {
    UploadServer server(folder);
    Result<server::UploadState> state = server.uploads.create(400, "", kSender, kNow_ms);
    ASSERT_TRUE(state.ok());
    id = state->row.id;
    power.acknowledge("bytes", 0);
    for (int i = 0; i < 2; ++i) {
      state = send(server.uploads, *state, payload(i));
      ASSERT_TRUE(state.ok());
      power.acknowledge("bytes", state->offset_bytes);
    }
    power.acknowledge("job");
    const Result<server::UploadState> other = server.uploads.create(400, "", kSender, kNow_ms);
    ASSERT_TRUE(other.ok());
    removed = other->row.id;
    ASSERT_TRUE(server.uploads.remove(removed, kSender, kNow_ms).ok());
    power.acknowledge("removed");
  };
  trial.look = [](const std::string& folder, const Acknowledged& acknowledged) {
    UploadServer server(folder);
    const Result<server::UploadState> found = server.uploads.find(id, kSender, kNow_ms);
    if (const auto bytes = acknowledged.find("bytes"); bytes != acknowledged.end()) {
      ASSERT_TRUE(found.ok()) << found.error().message;
      EXPECT_GE(found->offset_bytes, bytes->second);
      std::string held(static_cast<std::size_t>(bytes->second), '\0');
      std::ifstream(server.data.upload_path(id), std::ios::binary).read(held.data(), bytes->second);
      EXPECT_EQ(held, (payload(0) + payload(1)).substr(0, held.size()));
    }
    if (acknowledged.contains("job")) {
      EXPECT_TRUE(server.store.jobs.find(id).ok());
    }
    if (acknowledged.contains("removed")) {
      EXPECT_FALSE(server.uploads.find(removed, kSender, kNow_ms).ok());
    }
    EXPECT_TRUE(server.uploads.create(1, "", kSender, kNow_ms).ok());
  };
  cut_at_every_call(trial);
}

server::ScanRow row_of(const std::string& id,
                       server::ScanPhase phase = server::ScanPhase::kRunning) {
  server::ScanRow row;
  row.id = id;
  row.phase = phase;
  row.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
  return row;
}

TEST(PowerCut, RowsThatWereStoredAreInTheDatabase) {
  CutTrial trial;
  trial.work = [](const std::string& folder, PowerCut& power) {
    const server::DataDirectory data(folder);
    server::Store store(data.database_path());
    const auto done = [&power](const std::string& what, const Status& status) {
      ASSERT_TRUE(status.ok()) << what;
      power.acknowledge(what);
    };
    done("scan", store.scans.add(row_of("scan")));
    done("end", store.scans.update(row_of("scan", server::ScanPhase::kFinished)));
    server::TokenRow token;
    token.id = "token";
    token.secret_sha256 = digest::sha256("x");
    done("token", store.tokens.add(token));
    done("revoked", store.tokens.revoke("token", 1));
    done("second scan", store.scans.add(row_of("second scan")));
    done("removed", store.scans.remove("second scan"));
  };
  trial.look = [](const std::string& folder, const Acknowledged& acknowledged) {
    const server::DataDirectory data(folder);
    server::Store store(data.database_path());
    EXPECT_TRUE(store.check_integrity().ok());
    const Result<server::ScanRow> scan = store.scans.find("scan");
    EXPECT_TRUE(scan.ok() || !acknowledged.contains("scan"));
    EXPECT_TRUE(!acknowledged.contains("end") ||
                (scan.ok() && scan->phase == server::ScanPhase::kFinished));
    const Result<server::TokenRow> token = store.tokens.find("token");
    EXPECT_TRUE(token.ok() || !acknowledged.contains("token"));
    EXPECT_TRUE(!acknowledged.contains("revoked") || (token.ok() && token->revoked_at_ms == 1));
    EXPECT_TRUE(!acknowledged.contains("removed") || !store.scans.find("second scan").ok());
    EXPECT_TRUE(store.scans.add(row_of("afterwards")).ok());
  };
  cut_at_every_call(trial);
}

const std::string kBackedUpScan = server::new_scan_id();

void make_data(const std::string& folder) {
  const server::DataDirectory data(folder);
  server::Store store(data.database_path());
  ASSERT_TRUE(store.scans.add(row_of(kBackedUpScan)).ok());
  ASSERT_TRUE(
      server::FileBlobs(data.scans_folder()).put(kBackedUpScan, "report.json", "report").ok());
}

void expect_whole(const std::string& folder) {
  const Result<std::string> report =
      server::FileBlobs(folder + "/scans").read(kBackedUpScan, "report.json", 0, 100);
  EXPECT_TRUE(report.ok() && *report == "report");
  const server::DataDirectory data(folder);
  EXPECT_TRUE(server::Store(data.database_path()).scans.find(kBackedUpScan).ok());
}

TEST(PowerCut, ABackupIsWholeOrNotThere) {
  CutTrial trial;
  trial.prepare = [](const std::string& folder) { make_data(folder + "/data"); };
  trial.work = [](const std::string& folder, PowerCut& power) {
    ASSERT_TRUE(server::back_up(folder + "/data", folder + "/backup").ok());
    power.acknowledge("backed up");
  };
  trial.look = [](const std::string& folder, const Acknowledged& acknowledged) {
    if (acknowledged.contains("backed up")) {
      ASSERT_TRUE(fs::exists(folder + "/backup"));
    }
    if (fs::exists(folder + "/backup")) {
      ASSERT_TRUE(server::restore(folder + "/backup", folder + "/restored").ok());
      expect_whole(folder + "/restored");
    }
    expect_whole(folder + "/data");
  };
  cut_at_every_call(trial);
}

// A server does not start with half of it, and what was cut off is begun anew by the same command.
TEST(PowerCut, ARestoreIsWholeOrBegunAnew) {
  CutTrial trial;
  trial.prepare = [](const std::string& folder) {
    make_data(folder + "/data");
    ASSERT_TRUE(server::back_up(folder + "/data", folder + "/backup").ok());
  };
  trial.work = [](const std::string& folder, PowerCut& power) {
    ASSERT_TRUE(server::restore(folder + "/backup", folder + "/restored").ok());
    power.acknowledge("restored");
  };
  trial.look = [](const std::string& folder, const Acknowledged& acknowledged) {
    const std::string restored = folder + "/restored";
    const bool begun = fs::exists(restored) && !fs::is_empty(restored);
    if (!acknowledged.contains("restored") &&
        (!begun || fs::exists(restored + "/" + server::kRestoreMark))) {
      if (begun) {
        EXPECT_THROW(server::DataDirectory{restored}, SetupError);
      }
      ASSERT_TRUE(server::restore(folder + "/backup", restored).ok());
    }
    expect_whole(restored);
  };
  cut_at_every_call(trial);
}

TEST(PowerCut, TheTokenThatWasToldStays) {
  static std::string token;
  CutTrial trial;
  trial.work = [](const std::string& folder, PowerCut& power) {
    token = server::DataDirectory(folder + "/data").token();
    power.acknowledge("token");
  };
  trial.look = [](const std::string& folder, const Acknowledged& acknowledged) {
    const std::string found = server::DataDirectory(folder + "/data").token();
    EXPECT_EQ(found.size(), 64u);
    if (acknowledged.contains("token")) {
      EXPECT_EQ(found, token);
    }
  };
  cut_at_every_call(trial);
}

// And a cut is not taken for somebody who has cut entries off.
TEST(PowerCut, TheAuditLogKeepsWhatItHasSyncedAndSaysNothingIsMissing) {
  CutTrial trial;
  trial.work = [](const std::string& folder, PowerCut& power) {
    for (int start = 0; start < 2; ++start) {
      server::Audit audit(folder + "/audit", 0);
      for (int i = 0; i < 2; ++i) {
        audit.note({0, "token", "10.0.0.1", "DELETE scan", "x", "200"});
        audit.tick(0);
        power.acknowledge("entries", static_cast<std::int64_t>(audit.entry_count()));
      }
    }
  };
  trial.look = [](const std::string& folder, const Acknowledged& acknowledged) {
    { EXPECT_EQ(server::Audit(folder + "/audit", 0).missing(), ""); }
    const Result<server::AuditCheck> check =
        server::check_audit(folder + "/audit", [](const std::string&) {});
    ASSERT_TRUE(check.ok());
    EXPECT_EQ(check->broken, "");
    const auto entries = acknowledged.find("entries");
    EXPECT_GE(static_cast<std::int64_t>(check->entry_count),
              entries == acknowledged.end() ? 0 : entries->second);
  };
  cut_at_every_call(trial);
}

}  // namespace
}  // namespace hermite
