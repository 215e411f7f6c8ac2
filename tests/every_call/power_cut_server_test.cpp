// A power cut under a whole server: a scan over its socket from hello to result, with what its
// camera is told noted beside every call that changes a file. Needs a GPU, as the scan does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/log/frame_log.h"
#include "core/pipeline/doctor.h"
#include "proto/wire/frame_payload.h"
#include "server/store/data_directory.h"
#include "server/store/file_blobs.h"
#include "server/store/store.h"
#include "tests/every_call/power_cut.h"
#include "tests/support/raw_client.h"
#include "tests/support/room_frames.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

using test::PowerCut;
using test::RawClient;

struct Told {
  std::string scan_id, report_json;  // of the result
};

// Sends all frames of the room and takes what is answered.
Told scan_with(test::RunningServer& server, PowerCut& power) {
  RawClient camera(server.port());
  EXPECT_TRUE(camera.upgrade());
  wire::StartScan request{"a test",
                          test::room().camera(),
                          {wire::DepthCodec::kRvlZstd},
                          {wire::ColorCodec::kPng},
                          wire::Mode::kBatch,
                          {},
                          0};
  camera.send_message(wire::Hello{wire::kProtocolMinor, "test", server.token(), request});
  const auto welcome = camera.read<wire::Welcome>();
  if (!welcome) return {};
  power.acknowledge("begun");
  for (int i = 0; i < test::kFrameCount; ++i) camera.send_message(test::room_frame(i));
  bool sent = false;
  while (const auto message = camera.read_message()) {
    if (const auto* credit = std::get_if<wire::Credit>(&*message))
      power.acknowledge("frames", static_cast<std::int64_t>(credit->durable_frames));
    if (const auto* result = std::get_if<wire::FrameResult>(&*message);
        result && result->sequence + 1 == test::kFrameCount && !sent) {
      camera.send_message(wire::Finish{});
      sent = true;
    }
    if (const auto* finished = std::get_if<wire::Finished>(&*message)) {
      power.acknowledge("finished");
      return {welcome->scan_id, finished->report_json};
    }
  }
  return {welcome->scan_id, ""};
}

void look_at_scan(const std::string& folder, const Told& told,
                  const test::Acknowledged& acknowledged) {
  const server::DataDirectory data(folder);
  server::Store store(data.database_path());
  const Result<server::ScanRow> row = store.scans.find(told.scan_id);
  EXPECT_TRUE(row.ok() || !acknowledged.contains("begun"));
  if (!row.ok()) return;
  EXPECT_TRUE(row->phase == server::ScanPhase::kFinished ||
              (row->phase == server::ScanPhase::kRunning && !acknowledged.contains("finished")));
  const auto durable = acknowledged.find("frames");
  const Result<frame_log::FrameLog::Opened> log = frame_log::FrameLog::open(
      data.log_folder(told.scan_id), {[](std::uint64_t) {}, [](const Error&) {}});
  ASSERT_TRUE(log.ok()) << "a scan that is listed has a log: " << log.error().message;
  EXPECT_GE(static_cast<std::int64_t>(log->contents.frame_count),
            durable == acknowledged.end() ? 0 : durable->second);
  if (row->phase != server::ScanPhase::kFinished) return;
  server::FileBlobs blobs(data.scans_folder());
  for (const char* name : {"cloud.ply", "surfels.ply", "trajectory.txt", "chunks.bin"})
    EXPECT_TRUE(blobs.size_bytes(told.scan_id, name).ok()) << name;
  const Result<std::string> report = blobs.read(told.scan_id, "report.json", 0, 1'000'000);
  EXPECT_TRUE(report.ok() && *report == told.report_json);
}

TEST(PowerCutServer, EveryStateOfAScanIsOneThatTheNextServerGoesOnWith) {
  if (const auto problems = pipeline::examine_device("").problems; !problems.empty())
    GTEST_SKIP() << "no fit GPU here: " << problems.front();
  Told told;
  std::vector<test::DiskImage> images;
  int calls = 0;
  {
    const test::TemporaryFolder folder;
    PowerCut power(folder.path());
    test::RunningServer server(test::test_options(folder / "data"));
    told = scan_with(server, power);
    images = power.end();
    calls = power.call_count();
  }
  ASSERT_NE(told.report_json, "");
  std::printf("%d calls, %zu disks that differ\n", calls, images.size());
  EXPECT_GT(images.size(), 50u);
  for (const test::DiskImage& image : images) {
    SCOPED_TRACE(image.when);
    const test::TemporaryFolder folder;
    image.restore_into(folder.path());
    look_at_scan(folder / "data", told, image.acknowledged);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace hermite
