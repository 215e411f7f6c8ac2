// Files of other programs' formats, made of any sequence. Header only.
#pragma once

#include <array>
#include <cstring>
#include <string>

#include "core/dataset/sequence.h"
#include "core/image/image_codec.h"
#include "core/image/inflate.h"

namespace hermite::test {

using Bytes = std::vector<std::uint8_t>;

template <class Value>
void put(Bytes& bytes, const Value& value) {
  const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof value);
}

inline void put_all(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

inline Bytes raw_depth(const DepthImage& depth) {
  const auto* from = reinterpret_cast<const std::uint8_t*>(depth.pixels.data());
  return {from, from + 2 * depth.pixels.size()};
}

inline Bytes raw_color(const ColorImage& color) {
  const auto* from = reinterpret_cast<const std::uint8_t*>(color.pixels.data());
  return {from, from + 3 * color.pixels.size()};
}

struct FileOptions {
  bool raw_depth = false, raw_color = false, no_color = false;
  double stamp_units_per_second = 1e6;
  int color_factor = 1;  // of .sens: each pixel so many times across and down
};

inline frame::RgbdFrame frame_of(const dataset::Sequence& sequence, std::int64_t index) {
  return *dataset::decode_frame(*sequence.read(index));
}

inline ColorImage enlarged(const ColorImage& color, int factor) {
  ColorImage large(color.width * factor, color.height * factor);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x) large.at(x, y) = color.at(x / factor, y / factor);
  return large;
}

inline Bytes color_part(const ColorImage& color, const FileOptions& options) {
  if (options.no_color) return {};
  return options.raw_color ? raw_color(color) : *image::encode_jpeg(color, 95);
}

inline Bytes depth_part(const DepthImage& depth, const FileOptions& options) {
  return options.raw_depth ? raw_depth(depth) : image::deflate_bytes(raw_depth(depth));
}

inline Bytes klg_bytes(const dataset::Sequence& sequence, const FileOptions& options = {}) {
  Bytes bytes;
  put(bytes, static_cast<std::int32_t>(sequence.frame_count()));
  for (std::int64_t i = 0; i < sequence.frame_count(); ++i) {
    const frame::RgbdFrame frame = frame_of(sequence, i);
    const Bytes depth = depth_part(frame.depth, options), color = color_part(frame.color, options);
    put(bytes,
        static_cast<std::int64_t>((1000 + frame.timestamp_s) * options.stamp_units_per_second));
    put(bytes, static_cast<std::int32_t>(depth.size()));
    put(bytes, static_cast<std::int32_t>(color.size()));
    put_all(bytes, depth);
    put_all(bytes, color);
  }
  return bytes;
}

inline std::array<float, 16> floats(const Eigen::Matrix4d& matrix) {
  std::array<float, 16> values{};
  for (int i = 0; i < 16; ++i)
    values[static_cast<std::size_t>(i)] = static_cast<float>(matrix(i / 4, i % 4));
  return values;
}

inline Eigen::Matrix4d intrinsics(const Camera& camera, int factor) {
  Eigen::Matrix4d k = Eigen::Matrix4d::Identity();
  k(0, 0) = camera.fx * factor;
  k(1, 1) = camera.fy * factor;
  k(0, 2) = (camera.cx + 0.5) * factor - 0.5;
  k(1, 2) = (camera.cy + 0.5) * factor - 0.5;
  return k;
}

inline Bytes sens_bytes(const dataset::Sequence& sequence, const FileOptions& options = {},
                        const Eigen::Matrix4d& depth_extrinsics = Eigen::Matrix4d::Identity()) {
  const Camera& camera = sequence.camera();
  Bytes bytes;
  put(bytes, std::uint32_t{4});
  const std::string name = "StructureSensor";
  put(bytes, static_cast<std::uint64_t>(name.size()));
  bytes.insert(bytes.end(), name.begin(), name.end());
  put(bytes, floats(intrinsics(camera, options.color_factor)));
  put(bytes, floats(Eigen::Matrix4d::Identity()));
  put(bytes, floats(intrinsics(camera, 1)));
  put(bytes, floats(depth_extrinsics));
  put(bytes, std::int32_t{options.raw_color ? 0 : 2});
  put(bytes, std::int32_t{options.raw_depth ? 0 : 1});
  for (const int side : {camera.width * options.color_factor, camera.height * options.color_factor,
                         camera.width, camera.height})
    put(bytes, static_cast<std::uint32_t>(side));
  put(bytes, static_cast<float>(camera.depth_units_per_metre));
  put(bytes, static_cast<std::uint64_t>(sequence.frame_count()));
  for (std::int64_t i = 0; i < sequence.frame_count(); ++i) {
    const frame::RgbdFrame frame = frame_of(sequence, i);
    const Bytes depth = depth_part(frame.depth, options),
                color = color_part(enlarged(frame.color, options.color_factor), options);
    put(bytes,
        floats(sequence.groundtruth()[static_cast<std::size_t>(i)].world_from_camera.matrix()));
    const auto stamp =
        static_cast<std::uint64_t>(frame.timestamp_s * options.stamp_units_per_second);
    for (const std::uint64_t number : {stamp, stamp, static_cast<std::uint64_t>(color.size()),
                                       static_cast<std::uint64_t>(depth.size())})
      put(bytes, number);
    put_all(bytes, color);
    put_all(bytes, depth);
  }
  put(bytes, std::uint64_t{0});
  return bytes;
}

// "0 0 1" and a matrix, for each pose.
inline std::string redwood_log(const dataset::Trajectory& trajectory) {
  std::string text;
  char line[200];
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    text += std::to_string(i) + "\t" + std::to_string(i) + "\t" + std::to_string(i + 1) + "\n";
    const Eigen::Matrix4d m = trajectory[i].world_from_camera.matrix();
    for (int row = 0; row < 4; ++row) {
      std::snprintf(line, sizeof line, "%.9f %.9f %.9f %.9f\n", m(row, 0), m(row, 1), m(row, 2),
                    m(row, 3));
      text += line;
    }
  }
  return text;
}

}  // namespace hermite::test
