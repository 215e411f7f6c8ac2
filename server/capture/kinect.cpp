#include "server/capture/kinect.h"

#include <fmt/core.h>
#include <libfreenect.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/dataset/accelerometer.h"
#include "core/dataset/associate.h"
#include "core/dataset/recorded_folder.h"
#include "server/capture/device_clock.h"
#include "server/capture/frame_pairing.h"
#include "server/capture/kinect_depth.h"

namespace hermite::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWidth_px = 640, kHeight_px = 480;
constexpr double kRate_hz = 30;
constexpr double kTicksPerSecond = 60e6;  // two million per frame

// The usual intrinsics for the colour camera of an uncalibrated Kinect; individual ones differ by
// some pixels.
Camera nominal_color_camera() { return {kWidth_px, kHeight_px, 525, 525, 319.5, 239.5, 1000}; }

// The same for the depth camera, with the colour camera beside it.
Camera nominal_depth_camera() {
  Camera camera{kWidth_px, kHeight_px, 585, 585, 320, 240, 1000};
  camera.color = dataset::seven_scenes_color_camera(camera);
  return camera;
}

std::optional<freenect_frame_mode> find_depth_mode(freenect_depth_format format) {
  for (int i = 0; i < freenect_get_depth_mode_count(); ++i) {
    const freenect_frame_mode mode = freenect_get_depth_mode(i);
    if (mode.is_valid && mode.resolution == FREENECT_RESOLUTION_MEDIUM &&
        mode.depth_format == format)
      return mode;
  }
  return std::nullopt;
}

double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

// Opens and closes libfreenect. Silences its messages, which would be written into the progress
// display.
class Context {
 public:
  Context() {
    if (freenect_init(&context_, nullptr) < 0) context_ = nullptr;
    if (!context_) return;
    freenect_set_log_level(context_, FREENECT_LOG_FATAL);
  }
  ~Context() {
    if (context_) freenect_shutdown(context_);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  freenect_context* get() const { return context_; }

  // Returns null when another program uses the camera or this user may not. The accelerometer is a
  // part of the motor, which needs permissions and, in some models, firmware of its own; a camera
  // without it is one still.
  freenect_device* open(int index) {
    for (const int motor : {int{FREENECT_DEVICE_MOTOR}, 0}) {
      freenect_select_subdevices(
          context_, static_cast<freenect_device_flags>(FREENECT_DEVICE_CAMERA | motor));
      freenect_device* device = nullptr;
      if (freenect_open_device(context_, &device, index) >= 0) return device;
    }
    return nullptr;
  }

 private:
  freenect_context* context_ = nullptr;
};

class Kinect final : public CaptureCamera {
 public:
  Kinect(const std::string& name, const std::optional<Camera>& intrinsics);
  ~Kinect() override {
    if (!device_) return;
    freenect_stop_video(device_);
    freenect_stop_depth(device_);
    freenect_close_device(device_);
  }
  Kinect(const Kinect&) = delete;
  Kinect& operator=(const Kinect&) = delete;

  Status start(int index);
  const CameraDescription& description() const override { return description_; }
  Result<std::optional<frame::RgbdFrame>> next(std::chrono::milliseconds patience) override;
  LeftOut left_out() const override { return {.unpaired = pairing_.unpaired_depth_count()}; }

 private:
  // Called by libfreenect from within next().
  static void on_depth(freenect_device* device, void* data, std::uint32_t ticks);
  static void on_color(freenect_device* device, void* data, std::uint32_t ticks);
  std::optional<Eigen::Vector3d> felt_m_s2();
  static Kinect& of(freenect_device* device) {
    return *static_cast<Kinect*>(freenect_get_user(device));
  }

  // libfreenect registers depth to colour. fakenect does not, and provides the sensor's 11-bit
  // values.
  const std::optional<freenect_frame_mode> registered_ = find_depth_mode(FREENECT_DEPTH_REGISTERED);
  const CameraDescription description_;
  Context context_;
  freenect_device* device_ = nullptr;
  bool feels_ = true;
  DeviceClock clock_{kTicksPerSecond};
  FramePairing pairing_{dataset::kMaxAssociationGap_s};
};

Kinect::Kinect(const std::string& name, const std::optional<Camera>& intrinsics)
    : description_{
          name, intrinsics.value_or(registered_ ? nominal_color_camera() : nominal_depth_camera()),
          intrinsics ? "given" : "nominal for every Kinect v1", kRate_hz} {}

void Kinect::on_depth(freenect_device* device, void* data, std::uint32_t ticks) {
  DepthImage depth(kWidth_px, kHeight_px);
  std::memcpy(depth.pixels.data(), data, depth.pixels.size() * sizeof(std::uint16_t));
  Kinect& kinect = of(device);
  if (!kinect.registered_)
    std::transform(depth.pixels.begin(), depth.pixels.end(), depth.pixels.begin(), kinect_depth_mm);
  kinect.pairing_.add_depth(kinect.clock_.seconds_of(ticks, now_s()), std::move(depth));
}

void Kinect::on_color(freenect_device* device, void* data, std::uint32_t ticks) {
  ColorImage color(kWidth_px, kHeight_px);
  std::memcpy(color.pixels.data(), data, color.pixels.size() * sizeof(Rgb8));
  Kinect& kinect = of(device);
  kinect.pairing_.add_color(kinect.clock_.seconds_of(ticks, now_s()), std::move(color));
}

Status Kinect::start(int index) {
  if (!context_.get())
    return Error{ErrorCode::kDevice, "libfreenect cannot use USB on this machine"};
  const int count = freenect_num_devices(context_.get());
  if (index >= count)
    return Error{ErrorCode::kDevice,
                 fmt::format("there is no {}: {} are attached", description_.name, count)};
  device_ = context_.open(index);
  if (!device_)
    return Error{
        ErrorCode::kDevice,
        description_.name +
            " cannot be opened: another program uses it, or this user may not (the udev rules of "
            "libfreenect0.5 allow the group plugdev)"};
  freenect_set_user(device_, this);
  freenect_set_depth_callback(device_, on_depth);
  freenect_set_video_callback(device_, on_color);
  const auto depth_mode = registered_ ? registered_ : find_depth_mode(FREENECT_DEPTH_11BIT);
  const auto color_mode = freenect_find_video_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_VIDEO_RGB);
  const bool starts = depth_mode && freenect_set_depth_mode(device_, *depth_mode) >= 0 &&
                      freenect_set_video_mode(device_, color_mode) >= 0 &&
                      freenect_start_depth(device_) >= 0 && freenect_start_video(device_) >= 0;
  if (!starts)
    return Error{
        ErrorCode::kDevice,
        description_.name +
            " does not start: it may have no power, or share its USB controller with others"};
  return Done{};
}

// Asks the sensor, which takes about a millisecond. Zeros are what libfreenect gives before the
// sensor has answered, and without one.
std::optional<Eigen::Vector3d> Kinect::felt_m_s2() {
  feels_ = feels_ && freenect_update_tilt_state(device_) >= 0;
  if (!feels_) return std::nullopt;
  Eigen::Vector3d felt_m_s2;
  freenect_get_mks_accel(freenect_get_tilt_state(device_), &felt_m_s2.x(), &felt_m_s2.y(),
                         &felt_m_s2.z());
  if (felt_m_s2.isZero()) return std::nullopt;
  return dataset::camera_from_kinect_accelerometer() * felt_m_s2;
}

Result<std::optional<frame::RgbdFrame>> Kinect::next(std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  for (;;) {
    if (auto frame = pairing_.take()) {
      frame->acceleration_m_s2 = felt_m_s2();
      return frame;
    }
    const auto left =
        std::chrono::duration_cast<std::chrono::microseconds>(deadline - Clock::now());
    if (left.count() <= 0) return std::optional<frame::RgbdFrame>();
    timeval wait{.tv_sec = left.count() / 1'000'000, .tv_usec = left.count() % 1'000'000};
    if (freenect_process_events_timeout(context_.get(), &wait) < 0)
      return Error{ErrorCode::kDevice,
                   description_.name + " does not answer any more: was it unplugged?"};
  }
}

std::string name_of_kinect(int index) { return fmt::format("Kinect v1 ({})", index + 1); }

}  // namespace

std::vector<std::string> find_kinects() {
  const Context context;
  std::vector<std::string> names;
  const int count = context.get() ? freenect_num_devices(context.get()) : 0;
  for (int i = 0; i < count; ++i) names.push_back(name_of_kinect(i));
  return names;
}

Result<std::unique_ptr<CaptureCamera>> open_kinect(int index,
                                                   const std::optional<Camera>& intrinsics) {
  if (intrinsics && (intrinsics->width != kWidth_px || intrinsics->height != kHeight_px))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the intrinsics are of {}x{} pixels, the camera gives 640x480",
                             intrinsics->width, intrinsics->height)};
  auto kinect = std::make_unique<Kinect>(name_of_kinect(index), intrinsics);
  if (Status status = kinect->start(index); !status.ok()) return status.error();
  return std::unique_ptr<CaptureCamera>(std::move(kinect));
}

}  // namespace hermite::client
