// A recording of a Kinect v1 as fakenect-record writes it and fakenect plays it: images of 640x480,
// one file each, and a list of them. Written from the format alone. Header only.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/frame/rgbd_frame.h"

namespace hermite::test {

// The sensor's 11 bits that come nearest to a depth, by OpenKinect's formula; 2047: none.
inline std::uint16_t raw_depth(std::uint16_t depth_mm) {
  if (depth_mm < 400 || depth_mm > 9000) return 2047;
  return static_cast<std::uint16_t>(std::lround((3.3309495161 - 1000.0 / depth_mm) / 0.0030711016));
}

class FakenectDump {
 public:
  // `folder` is there and empty. The camera's ticks begin shortly before they are full.
  explicit FakenectDump(const std::filesystem::path& folder)
      : folder_(folder), index_(folder / "INDEX.txt") {}

  // `depth_mm` and colour of 640x480.
  void add_depth(double time_s, const DepthImage& depth_mm) {
    std::ofstream file = open('d', time_s, "pgm", "P5 640 480 65535\n");
    for (const std::uint16_t depth : depth_mm.pixels) {
      const std::uint16_t raw = raw_depth(depth);
      file.write(reinterpret_cast<const char*>(&raw), sizeof raw);
    }
  }
  void add_color(double time_s, const ColorImage& color) {
    std::ofstream file = open('r', time_s, "ppm", "P6 640 480 255\n");
    file.write(reinterpret_cast<const char*>(color.pixels.data()),
               static_cast<std::streamsize>(color.pixels.size() * sizeof(Rgb8)));
  }

  // As the sensor gives it: x left, y up, z forward, 819 per g. The file is libfreenect's
  // freenect_raw_tilt_state, with the state of the motor behind.
  void add_acceleration(double time_s, const Eigen::Matrix<std::int16_t, 3, 1>& felt) {
    std::ofstream file = open('a', time_s, "dump", "");
    const std::int16_t counts[6] = {felt.x(), felt.y(), felt.z(), 0, 0, 0};
    file.write(reinterpret_cast<const char*>(counts), sizeof counts);
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
};

}  // namespace hermite::test
