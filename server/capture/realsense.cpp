#include "server/capture/realsense.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <librealsense2/rs.hpp>
#include <thread>
#include <utility>

#include "core/image/image_codec.h"

namespace hermite::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr image::ImageSize kSize{640, 480};
constexpr int kRate_hz = 30;
// Much shorter than the time between two frames.
constexpr std::chrono::milliseconds kPollPeriod(2);
// Time after which to check whether the camera is still attached.
constexpr std::chrono::seconds kSilence(2);

// Turns exceptions of the library into errors: `what` says what failed. `call` returns a Result.
template <class Call>
auto with_errors(const std::string& what, const Call& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& failure) {
    return Error{ErrorCode::kDevice, what + ": " + failure.what()};
  }
}

struct Found {
  std::string name, serial;
};

Result<std::vector<Found>> find_devices(const rs2::context& context) {
  return with_errors("RealSense cameras cannot be looked for", [&]() -> Result<std::vector<Found>> {
    std::vector<Found> found;
    const rs2::device_list devices = context.query_devices();
    for (std::uint32_t i = 0; i < devices.size(); ++i) {
      const rs2::device device = devices[i];
      const std::string serial = device.get_info(RS2_CAMERA_INFO_SERIAL_NUMBER);
      found.push_back({std::string(device.get_info(RS2_CAMERA_INFO_NAME)) + " " + serial, serial});
    }
    return found;
  });
}

// Only the library's Brown-Conrady model is the same as ours. Other models count as undistorted:
// most cameras of the D400 series have only zeros there.
Distortion lens_of(const rs2_intrinsics& intrinsics) {
  if (intrinsics.model != RS2_DISTORTION_BROWN_CONRADY) return {};
  const auto& k = intrinsics.coeffs;
  return {k[0], k[1], k[2], k[3], k[4]};
}

class RealSenseCamera final : public CaptureCamera {
 public:
  explicit RealSenseCamera(Found found) : serial_(std::move(found.serial)), pipeline_(context_) {
    description_.name = std::move(found.name);
  }
  ~RealSenseCamera() override {
    if (started_)
      static_cast<void>(with_errors("", [this]() -> Status { return pipeline_.stop(), Done{}; }));
  }
  RealSenseCamera(const RealSenseCamera&) = delete;
  RealSenseCamera& operator=(const RealSenseCamera&) = delete;

  Status start(const std::optional<Camera>& intrinsics);
  const CameraDescription& description() const override { return description_; }
  Result<std::optional<frame::RgbdFrame>> next(std::chrono::milliseconds patience) override;

 private:
  Status describe(const rs2::pipeline_profile& profile, const std::optional<Camera>& intrinsics);
  Result<std::optional<frame::RgbdFrame>> poll();
  Status look_for_it();

  const std::string serial_;
  CameraDescription description_;
  rs2::context context_;
  rs2::pipeline pipeline_;
  rs2::align align_{RS2_STREAM_COLOR};
  bool started_ = false;
  double last_time_s_ = -1;
  Clock::time_point heard_at_;
};

Status RealSenseCamera::start(const std::optional<Camera>& intrinsics) {
  return with_errors(description_.name + " does not start (is it in use, or on a slow USB port?)",
                     [&]() -> Status {
                       rs2::config config;
                       config.enable_device(serial_);
                       config.enable_stream(RS2_STREAM_DEPTH, kSize.width, kSize.height,
                                            RS2_FORMAT_Z16, kRate_hz);
                       config.enable_stream(RS2_STREAM_COLOR, kSize.width, kSize.height,
                                            RS2_FORMAT_RGB8, kRate_hz);
                       const rs2::pipeline_profile profile = pipeline_.start(config);
                       started_ = true;
                       heard_at_ = Clock::now();
                       return describe(profile, intrinsics);
                     });
}

Status RealSenseCamera::describe(const rs2::pipeline_profile& profile,
                                 const std::optional<Camera>& intrinsics) {
  description_.frame_rate_hz = kRate_hz;
  description_.camera_source = intrinsics ? "given" : "the device";
  if (intrinsics) {
    description_.camera = *intrinsics;
    if (image::ImageSize{intrinsics->width, intrinsics->height} == kSize) return Done{};
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the intrinsics are of {}x{} pixels, the camera gives 640x480",
                             intrinsics->width, intrinsics->height)};
  }
  const rs2_intrinsics seen =
      profile.get_stream(RS2_STREAM_COLOR).as<rs2::video_stream_profile>().get_intrinsics();
  const double metres_per_unit = profile.get_device().first<rs2::depth_sensor>().get_depth_scale();
  // The unit is stored as a float, which is not exactly 0.001.
  description_.camera = {kSize.width,
                         kSize.height,
                         seen.fx,
                         seen.fy,
                         seen.ppx,
                         seen.ppy,
                         std::round(1 / metres_per_unit),
                         lens_of(seen)};
  const Status status = validate(description_.camera);
  return status.ok()
             ? status
             : in_context(fmt::format("what {} says of itself", description_.name), status.error());
}

template <class Pixel>
Status copy_rows(const rs2::video_frame& from, Image<Pixel>& to) {
  const std::size_t row_bytes = static_cast<std::size_t>(to.width) * sizeof(Pixel);
  const int stride_bytes = from.get_stride_in_bytes();
  if (from.get_width() != to.width || from.get_height() != to.height ||
      static_cast<std::size_t>(std::max(0, stride_bytes)) < row_bytes)
    return Error{ErrorCode::kDevice, "the camera gives images of another size than it said"};
  const auto* const bytes = static_cast<const std::uint8_t*>(from.get_data());
  for (int y = 0; y < to.height; ++y)
    std::memcpy(&to.at(0, y), bytes + static_cast<std::ptrdiff_t>(y) * stride_bytes, row_bytes);
  return Done{};
}

// Returns the available frame; std::nullopt if there is no pair of images, or an old one.
Result<std::optional<frame::RgbdFrame>> RealSenseCamera::poll() {
  return with_errors(description_.name + " does not answer any more",
                     [this]() -> Result<std::optional<frame::RgbdFrame>> {
                       rs2::frameset images;
                       if (!pipeline_.poll_for_frames(&images))
                         return std::optional<frame::RgbdFrame>();
                       heard_at_ = Clock::now();
                       if (!images.get_depth_frame() || !images.get_color_frame())
                         return std::optional<frame::RgbdFrame>();
                       const rs2::frameset aligned = align_.process(images);
                       const rs2::depth_frame depth = aligned.get_depth_frame();
                       const rs2::video_frame color = aligned.get_color_frame();
                       const double time_s = depth.get_timestamp() / 1000;
                       if (time_s <= last_time_s_) return std::optional<frame::RgbdFrame>();
                       last_time_s_ = time_s;
                       frame::RgbdFrame frame{time_s, DepthImage(kSize.width, kSize.height),
                                              ColorImage(kSize.width, kSize.height)};
                       if (Status status = copy_rows(depth, frame.depth); !status.ok())
                         return status.error();
                       if (Status status = copy_rows(color, frame.color); !status.ok())
                         return status.error();
                       return std::optional(std::move(frame));
                     });
}

// An unplugged camera is merely silent.
Status RealSenseCamera::look_for_it() {
  heard_at_ = Clock::now();
  const auto found = find_devices(context_);
  if (!found.ok()) return found.error();
  const bool there = std::any_of(found->begin(), found->end(),
                                 [this](const Found& device) { return device.serial == serial_; });
  if (there) return Done{};
  return Error{ErrorCode::kDevice, description_.name + " is not there any more: was it unplugged?"};
}

Result<std::optional<frame::RgbdFrame>> RealSenseCamera::next(std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  for (;;) {
    auto frame = poll();
    if (!frame.ok() || *frame) return frame;
    const auto now = Clock::now();
    if (now - heard_at_ >= kSilence)
      if (Status status = look_for_it(); !status.ok()) return status.error();
    if (now >= deadline) return std::optional<frame::RgbdFrame>();
    std::this_thread::sleep_for(kPollPeriod);
  }
}

Result<std::unique_ptr<CaptureCamera>> open_found(const Found& found,
                                                  const std::optional<Camera>& intrinsics) {
  return with_errors(found.name + " cannot be opened",
                     [&]() -> Result<std::unique_ptr<CaptureCamera>> {
                       auto camera = std::make_unique<RealSenseCamera>(found);
                       if (Status status = camera->start(intrinsics); !status.ok())
                         return status.error();
                       return std::unique_ptr<CaptureCamera>(std::move(camera));
                     });
}

Result<std::vector<Found>> find_devices() {
  return with_errors("RealSense cameras cannot be looked for",
                     []() { return find_devices(rs2::context()); });
}

}  // namespace

std::vector<std::string> find_realsense_cameras() {
  std::vector<std::string> names;
  const auto found = find_devices();
  if (!found.ok()) return names;
  for (const Found& device : *found) names.push_back(device.name);
  return names;
}

Result<std::unique_ptr<CaptureCamera>> open_realsense(int index,
                                                      const std::optional<Camera>& intrinsics) {
  const auto found = find_devices();
  if (!found.ok()) return found.error();
  if (static_cast<std::size_t>(index) >= found->size())
    return Error{ErrorCode::kDevice,
                 fmt::format("there is no camera {}: {} are attached", index + 1, found->size())};
  return open_found((*found)[static_cast<std::size_t>(index)], intrinsics);
}

Result<std::unique_ptr<CaptureCamera>> open_realsense_at(const std::string& serial,
                                                         const std::optional<Camera>& intrinsics) {
  return open_found({"RealSense " + serial, serial}, intrinsics);
}

}  // namespace hermite::client
