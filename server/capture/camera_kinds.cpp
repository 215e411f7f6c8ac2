#include "server/capture/camera_kinds.h"

#include <fmt/core.h>

#include <charconv>
#include <utility>

#include "core/source/open_sequence.h"
#include "server/capture/recording_camera.h"

#if HERMITE_WITH_FREENECT
#include "server/capture/kinect.h"
#endif
#if HERMITE_WITH_OPENNI2
#include "server/capture/openni.h"
#endif
#if HERMITE_WITH_REALSENSE
#include "server/capture/realsense.h"
#endif

namespace hermite::client {
namespace {

constexpr const char* kRecordingPrefix = "recording:";
constexpr int kMaxIndex = 99;  // more than any machine has USB controllers for

constexpr CameraKind kKinds[] = {
#if HERMITE_WITH_FREENECT
    {"kinect", "Kinect v1, by libfreenect", find_kinects, open_kinect, nullptr},
#else
    {"kinect", "Kinect v1, by libfreenect", nullptr, nullptr, nullptr},
#endif
#if HERMITE_WITH_OPENNI2
    {"openni", "Xtion, PrimeSense, Orbbec, by OpenNI2", find_openni_cameras, open_openni,
     open_openni_at},
#else
    {"openni", "Xtion, PrimeSense, Orbbec, by OpenNI2", nullptr, nullptr, nullptr},
#endif
#if HERMITE_WITH_REALSENSE
    {"realsense", "RealSense, by librealsense 2", find_realsense_cameras, open_realsense,
     open_realsense_at},
#else
    {"realsense", "RealSense, by librealsense 2", nullptr, nullptr, nullptr},
#endif
};

Error not_built(const CameraKind& kind) {
  return {ErrorCode::kUnsupported,
          std::string(kind.description) +
              ": not in this build (its library was not there when this was built)"};
}

Result<int> parse_index(const std::string& wish, const std::string& text) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  if (parsed.ec == std::errc() && parsed.ptr == end && number >= 1 && number <= kMaxIndex)
    return number - 1;
  return Error{
      ErrorCode::kInvalidArgument,
      fmt::format(
          "--camera \"{}\": behind the colon stands a number from 1 to {}, as --list counts", wish,
          kMaxIndex)};
}

Error unknown_kind(const std::string& wish) {
  std::string message = fmt::format("--camera \"{}\" is not known; there are", wish);
  for (const CameraKind& kind : kKinds) message += fmt::format(" {},", kind.name);
  return {ErrorCode::kInvalidArgument,
          fmt::format("{} each with :2 for the second, and {}SEQUENCE", message, kRecordingPrefix)};
}

// `which`: the part of `wish` after the colon.
Result<std::unique_ptr<CaptureCamera>> open_kind(const CameraKind& kind, const std::string& wish,
                                                 const std::string& which,
                                                 const std::optional<Camera>& intrinsics) {
  if (!kind.open) return not_built(kind);
  const Result<int> index = parse_index(wish, which);
  if (!index.ok() && (!kind.open_at || which.empty())) return index.error();
  auto camera = index.ok() ? kind.open(*index, intrinsics) : kind.open_at(which, intrinsics);
  return camera.ok() ? std::move(camera) : in_context(kind.description, camera.error());
}

Result<std::unique_ptr<CaptureCamera>> open_first(const std::optional<Camera>& intrinsics) {
  for (const CameraKind& kind : kKinds)
    if (kind.find && !kind.find().empty()) return open_kind(kind, kind.name, "1", intrinsics);
  return Error{ErrorCode::kNotFound, "no camera is attached\n" + list_cameras()};
}

Result<std::unique_ptr<CaptureCamera>> open_recording_camera(
    const std::string& source, const std::optional<Camera>& intrinsics) {
  Result<std::unique_ptr<dataset::Sequence>> sequence = source::open_sequence(source, intrinsics);
  if (!sequence.ok()) return sequence.error();
  return play_recording(*std::move(sequence));
}

}  // namespace

std::span<const CameraKind> camera_kinds() { return kKinds; }

std::string list_cameras() {
  std::string text;
  for (const CameraKind& kind : kKinds) {
    const std::vector<std::string> found = kind.find ? kind.find() : std::vector<std::string>();
    for (std::size_t i = 0; i < found.size(); ++i)
      text += fmt::format("{}:{}  {}\n", kind.name, i + 1, found[i]);
    if (!kind.find) text += fmt::format("{}  {}\n", kind.name, not_built(kind).message);
    if (kind.find && found.empty())
      text += fmt::format("{}  {}: none is attached\n", kind.name, kind.description);
  }
  return text;
}

Result<std::unique_ptr<CaptureCamera>> open_camera(const std::string& wish,
                                                   const std::optional<Camera>& intrinsics) {
  if (intrinsics)
    if (const Status status = validate(*intrinsics); !status.ok()) return status.error();
  if (wish.empty()) return open_first(intrinsics);
  if (wish.starts_with(kRecordingPrefix))
    return open_recording_camera(wish.substr(std::string(kRecordingPrefix).size()), intrinsics);
  const std::size_t colon = wish.find(':');
  for (const CameraKind& kind : kKinds)
    if (wish.substr(0, colon) == kind.name)
      return open_kind(kind, wish, colon == std::string::npos ? "1" : wish.substr(colon + 1),
                       intrinsics);
  return unknown_kind(wish);
}

}  // namespace hermite::client
