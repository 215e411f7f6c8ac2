#include "core/export/scan_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/dataset/camera_file.h"
#include "core/source/open_sequence.h"

namespace hermite::exports {
namespace {

using testing::HasSubstr;

std::string report_with(const char* key, const Camera& camera) {
  return std::string("{\"frames\": 3, \"") + key +
         "\": " + dataset::format_camera_json({camera, 30}) + "}";
}

TEST(ScanRecording, TakesTheCameraThatTheScanWasCorrectedTo) {
  const Camera camera =
      (*source::open_sequence("synthetic:frames=2,width=160,height=120"))->camera();
  Camera better = camera;
  better.fx *= 1.01;
  for (const char* key : {"corrected_camera", "camera"}) {
    const auto scanned =
        as_scanned(*source::open_sequence("synthetic:frames=2,width=160,height=120"),
                   report_with(key, better));
    ASSERT_TRUE(scanned.ok());
    EXPECT_NEAR((*scanned)->camera().fx, better.fx, 1e-9);
  }
  EXPECT_EQ((*as_scanned(*source::open_sequence("synthetic:frames=2,width=160,height=120"), "{}"))
                ->camera(),
            camera);
}

TEST(ScanRecording, RefusesWhatIsNoCameraOfIt) {
  Camera other = (*source::open_sequence("synthetic:frames=2,width=320,height=240"))->camera();
  const auto open = [] {
    return *source::open_sequence("synthetic:frames=2,width=160,height=120");
  };
  EXPECT_THAT(as_scanned(open(), report_with("camera", other)).error().message,
              HasSubstr("another size"));
  EXPECT_THAT(as_scanned(open(), R"({"corrected_camera": 7})").error().message,
              HasSubstr("corrected_camera"));
  EXPECT_TRUE(as_scanned(open(), "no report").ok()) << "which says nothing of a camera";
}

}  // namespace
}  // namespace hermite::exports
