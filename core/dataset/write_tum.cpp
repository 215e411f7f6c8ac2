#include "core/dataset/write_tum.h"

#include <fmt/core.h>

#include <charconv>

#include "core/archive/fresh_folder.h"
#include "core/dataset/accelerometer.h"
#include "core/dataset/camera_file.h"
#include "core/dataset/remarks.h"
#include "core/image/image_codec.h"

namespace hermite::dataset {
namespace {

// Returns the shortest text that reads back as the same number, without an exponent.
std::string exact_text(double time_s) {
  char text[400];  // enough for the digits of 1e-308
  const auto written = std::to_chars(text, text + sizeof text, time_s, std::chars_format::fixed);
  CHECK(written.ec == std::errc(), "a time that does not fit");
  return {text, written.ptr};
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Status write_file(const archive::FreshFolder& folder, const std::vector<std::string>& parts,
                  std::span<const std::uint8_t> bytes) {
  const Result<archive::OpenFile> file = folder.create(parts);
  const Status status = file.ok() ? file->write(bytes) : Status(file.error());
  return status.ok() ? status : in_context(parts.back(), status.error());
}

struct Lists {
  std::string colors = "# color images\n# timestamp filename\n";
  std::string depths = "# depth maps\n# timestamp filename\n";
  std::string associations = "# timestamp depth timestamp color\n";
  std::vector<TimedAcceleration> felt;  // in the axes of the camera
};

Status write_frame(const archive::FreshFolder& folder, const RecordedFrame& frame, Lists& lists) {
  const std::string time = exact_text(frame.timestamp_s);
  const auto format = image::detect_image_format(frame.color_bytes);
  if (!format.ok()) return format.error();
  const std::string color_name = time + (*format == image::ImageFormat::kJpeg ? ".jpg" : ".png"),
                    depth_name = time + ".png";
  const auto depth = image::encode_depth_png(frame.depth);
  if (!depth.ok()) return depth.error();
  if (const Status status = write_file(folder, {"depth", depth_name}, *depth); !status.ok())
    return status;
  if (const Status status = write_file(folder, {"rgb", color_name}, frame.color_bytes);
      !status.ok())
    return status;
  if (frame.acceleration_m_s2) lists.felt.push_back({frame.timestamp_s, *frame.acceleration_m_s2});
  lists.colors += fmt::format("{} rgb/{}\n", time, color_name);
  lists.depths += fmt::format("{} depth/{}\n", time, depth_name);
  lists.associations += fmt::format("{} depth/{} {} rgb/{}\n", time, depth_name, time, color_name);
  return Done{};
}

Status write_lists(const archive::FreshFolder& folder, const Lists& lists,
                   const Sequence& sequence) {
  CameraFile camera{sequence.camera(), sequence.frame_rate_hz(), true};
  if (!lists.felt.empty()) camera.camera_from_accelerometer = Eigen::Matrix3d::Identity();
  std::vector<std::pair<const char*, std::string>> files = {
      {"rgb.txt", lists.colors},
      {"depth.txt", lists.depths},
      {"associations.txt", lists.associations},
      {"camera.json", format_camera_json(camera)}};
  if (!lists.felt.empty()) files.emplace_back(kAccelerometerFile, format_accelerations(lists.felt));
  if (!sequence.groundtruth().empty())
    files.emplace_back("groundtruth.txt", format_tum_trajectory(sequence.groundtruth()));
  for (const auto& [name, text] : files)
    if (const Status status = write_file(folder, {name}, bytes_of(text)); !status.ok())
      return status;
  return Done{};
}

}  // namespace

Result<WriteSummary> write_tum(const Sequence& sequence, FrameRange range, const std::string& path,
                               const WriteProgress& progress) {
  const Result<archive::FreshFolder> folder = archive::FreshFolder::open(path);
  if (!folder.ok()) return folder.error();
  WriteSummary summary;
  Remarks left_out("frames that cannot be read are left out");
  Lists lists;
  for (std::int64_t i = range.begin; i < range.end; ++i) {
    const Result<RecordedFrame> frame = sequence.read(i);
    if (!frame.ok()) {
      left_out.add(frame.error().message);
    } else {
      if (const Status status = write_frame(*folder, *frame, lists); !status.ok())
        return in_context(path, status.error());
      ++summary.frame_count;
    }
    progress(i - range.begin + 1);
  }
  summary.remarks = left_out.lines();
  if (summary.frame_count == 0)
    return Error{ErrorCode::kCorruptData,
                 "not one frame could be read: " + summary.remarks.front()};
  if (const Status status = write_lists(*folder, lists, sequence); !status.ok())
    return in_context(path, status.error());
  return summary;
}

}  // namespace hermite::dataset
