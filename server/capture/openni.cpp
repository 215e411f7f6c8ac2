#include "server/capture/openni.h"

#include <OpenNI.h>
#include <fmt/core.h>

#include <cctype>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/dataset/associate.h"
#include "core/image/image_codec.h"
#include "server/capture/frame_pairing.h"

namespace hermite::client {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSecondsPerTick = 1e-6;  // of OpenNI2's timestamps
constexpr image::ImageSize kWantedSize{640, 480};
constexpr double kWantedRate_hz = 30;

Error failure(ErrorCode code, const std::string& what) {
  std::string reason = openni::OpenNI::getExtendedError();
  while (!reason.empty() && std::isspace(static_cast<unsigned char>(reason.back())))
    reason.pop_back();
  return {code, reason.empty() ? what : what + ": " + reason};
}

// Initialised once for the lifetime of the process: the library counts references, and shutting it
// down crashes with some of its drivers (Debian's 2.2.0.33 with its own virtual device).
bool library_is_there() {
  static const bool there = openni::OpenNI::initialize() == openni::STATUS_OK;
  return there;
}

// Returns the units per metre of a pixel format; 0: not a supported depth format.
double depth_units_of(openni::PixelFormat format) {
  if (format == openni::PIXEL_FORMAT_DEPTH_1_MM) return 1000;
  if (format == openni::PIXEL_FORMAT_DEPTH_100_UM) return 10'000;
  return 0;
}

image::ImageSize size_of(const openni::VideoMode& mode) {
  return {mode.getResolutionX(), mode.getResolutionY()};
}

// Lower is better: compares first the size, then the rate, then prefers millimetres.
double distance_to_wanted(const openni::VideoMode& mode) {
  const double size = std::abs(static_cast<double>(mode.getResolutionX()) / kWantedSize.width - 1);
  return 100 * size + std::abs(mode.getFps() / kWantedRate_hz - 1) +
         (depth_units_of(mode.getPixelFormat()) == 10'000 ? 0.01 : 0);
}

struct Modes {
  openni::VideoMode depth, color;
};

// Chooses depth and colour of the same size and rate.
std::optional<Modes> choose_modes(openni::Device& device) {
  const openni::SensorInfo* const depth = device.getSensorInfo(openni::SENSOR_DEPTH);
  const openni::SensorInfo* const color = device.getSensorInfo(openni::SENSOR_COLOR);
  std::optional<Modes> best;
  if (!depth || !color) return best;
  const auto& depth_modes = depth->getSupportedVideoModes();
  const auto& color_modes = color->getSupportedVideoModes();
  for (int d = 0; d < depth_modes.getSize(); ++d)
    for (int c = 0; c < color_modes.getSize(); ++c) {
      const bool fits = depth_units_of(depth_modes[d].getPixelFormat()) > 0 &&
                        color_modes[c].getPixelFormat() == openni::PIXEL_FORMAT_RGB888 &&
                        size_of(depth_modes[d]) == size_of(color_modes[c]) &&
                        depth_modes[d].getFps() == color_modes[c].getFps();
      if (fits && (!best || distance_to_wanted(depth_modes[d]) < distance_to_wanted(best->depth)))
        best = Modes{depth_modes[d], color_modes[c]};
    }
  return best;
}

class OpenNiCamera final : public CaptureCamera {
 public:
  explicit OpenNiCamera(std::string name) { description_.name = std::move(name); }
  ~OpenNiCamera() override {
    for (openni::VideoStream* stream : {&depth_, &color_}) {
      stream->stop();
      stream->destroy();
    }
    device_.close();
  }
  OpenNiCamera(const OpenNiCamera&) = delete;
  OpenNiCamera& operator=(const OpenNiCamera&) = delete;

  Status start(const char* address, const std::optional<Camera>& intrinsics);
  const CameraDescription& description() const override { return description_; }
  Result<std::optional<frame::RgbdFrame>> next(std::chrono::milliseconds patience) override;
  LeftOut left_out() const override { return {.unpaired = pairing_.unpaired_depth_count()}; }

 private:
  Status describe(const Modes& modes, bool is_registered, const std::optional<Camera>& intrinsics);
  Status take_image(bool is_depth);

  CameraDescription description_;
  openni::Device device_;
  openni::VideoStream depth_, color_;
  FramePairing pairing_{dataset::kMaxAssociationGap_s};
};

Status OpenNiCamera::start(const char* address, const std::optional<Camera>& intrinsics) {
  if (device_.open(address) != openni::STATUS_OK)
    return failure(ErrorCode::kDevice,
                   description_.name + " cannot be opened (is it in use, or not allowed?)");
  const std::optional<Modes> modes = choose_modes(device_);
  if (!modes)
    return Error{
        ErrorCode::kUnsupported,
        description_.name + " has no depth in millimetres beside colour of the same size and rate"};
  const bool is_registered =
      device_.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR) &&
      device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR) ==
          openni::STATUS_OK;
  device_.setDepthColorSyncEnabled(true);  // not every device supports it, so the timestamps decide
  const bool created = depth_.create(device_, openni::SENSOR_DEPTH) == openni::STATUS_OK &&
                       color_.create(device_, openni::SENSOR_COLOR) == openni::STATUS_OK;
  if (!created)
    return failure(ErrorCode::kDevice, description_.name + " gives no depth and colour at once");
  // A device with only one mode refuses this, too, so the actual images are checked.
  depth_.setVideoMode(modes->depth);
  color_.setVideoMode(modes->color);
  depth_.setMirroringEnabled(false);
  color_.setMirroringEnabled(false);
  if (depth_.getMirroringEnabled() || color_.getMirroringEnabled())
    return Error{ErrorCode::kUnsupported, description_.name + " gives mirrored images only"};
  if (Status status = describe(*modes, is_registered, intrinsics); !status.ok()) return status;
  if (depth_.start() != openni::STATUS_OK || color_.start() != openni::STATUS_OK)
    return failure(ErrorCode::kDevice, description_.name + " does not start");
  return Done{};
}

Status OpenNiCamera::describe(const Modes& modes, bool is_registered,
                              const std::optional<Camera>& intrinsics) {
  const image::ImageSize size = size_of(modes.depth);
  description_.frame_rate_hz = modes.depth.getFps();
  description_.camera_source = intrinsics      ? "given"
                               : is_registered ? "the device's field of view"
                                               : "the device's field of view; not registered";
  if (intrinsics) {
    description_.camera = *intrinsics;
    if (image::ImageSize{intrinsics->width, intrinsics->height} == size) return Done{};
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the intrinsics are of {}x{} pixels, the camera gives {}x{}",
                             intrinsics->width, intrinsics->height, size.width, size.height)};
  }
  // Registered depth has the view of the colour camera.
  const double angle_rad = (is_registered ? color_ : depth_).getHorizontalFieldOfView();
  const double focal_px = 0.5 * size.width / std::tan(0.5 * angle_rad);
  description_.camera = {size.width,
                         size.height,
                         focal_px,
                         focal_px,
                         0.5 * (size.width - 1),
                         0.5 * (size.height - 1),
                         depth_units_of(modes.depth.getPixelFormat())};
  if (const Status status = validate(description_.camera); !status.ok())
    return Error{ErrorCode::kUnsupported,
                 fmt::format("{} does not say what it sees ({}): give --intrinsics",
                             description_.name, status.error().message)};
  return Done{};
}

Status OpenNiCamera::take_image(bool is_depth) {
  openni::VideoFrameRef frame;
  if ((is_depth ? depth_ : color_).readFrame(&frame) != openni::STATUS_OK)
    return failure(ErrorCode::kDevice,
                   description_.name + " does not answer any more: was it unplugged?");
  const int width = description_.camera.width, height = description_.camera.height;
  const std::size_t row_bytes =
      static_cast<std::size_t>(width) * (is_depth ? sizeof(std::uint16_t) : sizeof(Rgb8));
  const bool as_announced = frame.getWidth() == width && frame.getHeight() == height &&
                            static_cast<std::size_t>(frame.getStrideInBytes()) >= row_bytes;
  if (!as_announced)
    return Error{ErrorCode::kDevice,
                 description_.name + " gives images of another size than it said"};
  const double time_s = static_cast<double>(frame.getTimestamp()) * kSecondsPerTick;
  const auto copy_rows = [&](auto& image) {
    const auto* const from = static_cast<const std::uint8_t*>(frame.getData());
    for (int y = 0; y < height; ++y)
      std::memcpy(&image.at(0, y), from + y * frame.getStrideInBytes(), row_bytes);
  };
  if (is_depth) {
    DepthImage depth(width, height);
    copy_rows(depth);
    pairing_.add_depth(time_s, std::move(depth));
  } else {
    ColorImage color(width, height);
    copy_rows(color);
    pairing_.add_color(time_s, std::move(color));
  }
  return Done{};
}

Result<std::optional<frame::RgbdFrame>> OpenNiCamera::next(std::chrono::milliseconds patience) {
  const auto deadline = Clock::now() + patience;
  for (;;) {
    if (auto frame = pairing_.take()) return frame;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    if (left.count() <= 0) return std::optional<frame::RgbdFrame>();
    openni::VideoStream* streams[] = {&depth_, &color_};
    int ready = -1;
    const openni::Status waited =
        openni::OpenNI::waitForAnyStream(streams, 2, &ready, static_cast<int>(left.count()));
    if (waited == openni::STATUS_TIME_OUT) return std::optional<frame::RgbdFrame>();
    if (waited != openni::STATUS_OK)
      return failure(ErrorCode::kDevice, description_.name + " does not answer any more");
    if (Status status = take_image(ready == 0); !status.ok()) return status.error();
  }
}

struct Found {
  std::string name, address;
};

std::vector<Found> find_devices() {
  std::vector<Found> found;
  if (!library_is_there()) return found;
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  for (int i = 0; i < devices.getSize(); ++i)
    found.push_back({fmt::format("{} {} ({})", devices[i].getVendor(), devices[i].getName(), i + 1),
                     devices[i].getUri()});
  return found;
}

Result<std::unique_ptr<CaptureCamera>> open_named(const Found& found,
                                                  const std::optional<Camera>& intrinsics) {
  if (!library_is_there()) return failure(ErrorCode::kDevice, "OpenNI2 cannot be started");
  auto camera = std::make_unique<OpenNiCamera>(found.name);
  if (Status status = camera->start(found.address.c_str(), intrinsics); !status.ok())
    return status.error();
  return std::unique_ptr<CaptureCamera>(std::move(camera));
}

}  // namespace

std::vector<std::string> find_openni_cameras() {
  std::vector<std::string> names;
  for (const Found& found : find_devices()) names.push_back(found.name);
  return names;
}

Result<std::unique_ptr<CaptureCamera>> open_openni(int index,
                                                   const std::optional<Camera>& intrinsics) {
  const std::vector<Found> found = find_devices();
  if (static_cast<std::size_t>(index) >= found.size())
    return Error{ErrorCode::kDevice,
                 fmt::format("there is no camera {}: {} are attached", index + 1, found.size())};
  return open_named(found[static_cast<std::size_t>(index)], intrinsics);
}

Result<std::unique_ptr<CaptureCamera>> open_openni_at(const std::string& address,
                                                      const std::optional<Camera>& intrinsics) {
  return open_named({address, address}, intrinsics);
}

}  // namespace hermite::client
