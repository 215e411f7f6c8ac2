// A recording of a Kinect v1 as fakenect-record writes it and fakenect plays it: images of 640x480, one file each, and a list of them.
// Written from the format alone. Header only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/frame/rgbd_frame.h"

namespace hermite::test {

// The sensor's 11 bits of disparity for each millimetre, by libfreenect's formula for the reference plane of `kDeviceJson`; 2047: none.
class RawDepths {
 public:
  RawDepths() {
    for (int raw = 0; raw < 2047; ++raw) {
      const double shift = (raw - 4.0 * 200) / 4 - 0.375, metric = shift * 0.1042;
      if (metric >= 7.5) break;
      mm_[static_cast<std::size_t>(raw)] = 10 * (metric * 120 / (7.5 - metric) + 120);
      count_ = raw + 1;
    }
  }
  std::uint16_t nearest(std::uint16_t depth_mm) const {
    if (depth_mm == 0 || depth_mm > 9000) return 2047;
    const auto end = mm_.begin() + count_;
    const auto above = std::lower_bound(mm_.begin(), end, static_cast<double>(depth_mm));
    if (above == end) return 2047;
    const bool below_is_nearer = above != mm_.begin() && depth_mm - above[-1] < above[0] - depth_mm;
    return static_cast<std::uint16_t>(above - mm_.begin() - (below_is_nearer ? 1 : 0));
  }

 private:
  std::array<double, 2047> mm_{};
  int count_ = 0;
};

// A Kinect whose colour camera sits where its depth camera does: registration moves nothing by more than a pixel.
inline constexpr const char* kDeviceJson =
    R"({"reg_info": {"pad_info": {"start_lines": 0}, "zero_plane_info": {"dcmos_emitter_distance": 7.5, "dcmos_rcmos_distance": 0,)"
    R"( "reference_distance": 120, "reference_pixel_size": 0.1042}}, "const_shift": 200})";

class FakenectDump {
 public:
  // `folder` is there and empty. The camera's ticks begin shortly before they are full.
  explicit FakenectDump(const std::filesystem::path& folder) : folder_(folder), index_(folder / "INDEX.txt") {
    std::ofstream(folder / "device.json") << kDeviceJson;
  }

  // `depth_mm` and colour of 640x480.
  void add_depth(double time_s, const DepthImage& depth_mm) {
    std::ofstream file = open('d', time_s, "pgm", "P5 640 480 65535\n");
    for (const std::uint16_t depth : depth_mm.pixels) {
      const std::uint16_t raw = raw_depths_.nearest(depth);
      file.write(reinterpret_cast<const char*>(&raw), sizeof raw);
    }
  }
  void add_color(double time_s, const ColorImage& color) {
    std::ofstream file = open('r', time_s, "ppm", "P6 640 480 255\n");
    file.write(reinterpret_cast<const char*>(color.pixels.data()), static_cast<std::streamsize>(color.pixels.size() * sizeof(Rgb8)));
  }

 private:
  std::ofstream open(char type, double time_s, const char* extension, const char* header) {
    const auto ticks = static_cast<std::uint32_t>(4'290'000'000 + std::llround(time_s * 60e6));
    char name[80];
    std::snprintf(name, sizeof name, "%c-%f-%u.%s", type, 1e9 + time_s, ticks, extension);
    index_ << name << '\n' << std::flush;
    std::ofstream file(folder_ / name, std::ios::binary);
    file << header;
    return file;
  }

  const std::filesystem::path folder_;
  std::ofstream index_;
  const RawDepths raw_depths_;
};

}  // namespace hermite::test
