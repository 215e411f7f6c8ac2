// .oni files made of any sequence, as OpenNI's recorders write them (core/dataset/oni_file.h).
// Header only.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/core/dataset/recording_bytes.h"
#include "tests/core/image/nibble_bytes.h"

namespace hermite::test {

struct OniOptions {
  std::string depth_codec = "16zT", color_codec = "JPEG";
  bool mirrored = false, cropped = false, has_view = true, has_color = true;
  bool old_positions = false;  // files before 1.0.1.0, of OpenNI 1
  bool has_end = true;
  std::int64_t color_frames_late = 0;  // colour begins so many frames after depth
  bool streams_from_zero = false;      // as OpenNI 2 has them
  std::int64_t oni_pixel_format = 100;
  int color_factor = 1;  // each pixel so many times across and down
};

class OniWriter {
 public:
  explicit OniWriter(const OniOptions& options) : options_(options) {
    for (const char letter : {'N', 'I', '1', '0'})
      bytes.push_back(static_cast<std::uint8_t>(letter));
    put_all(bytes,
            options.old_positions ? Bytes{1, 0, 0, 0, 6, 0, 0, 0} : Bytes{1, 0, 1, 0, 0, 0, 0, 0});
    put(bytes, ~std::uint64_t{0});
    put(bytes, std::uint32_t{2});
  }

  void record(std::uint32_t type, std::uint32_t node, const Bytes& fields = {},
              const Bytes& payload = {}) {
    const std::uint32_t header_bytes = options_.old_positions ? 24 : 28;
    for (const std::uint32_t number :
         {std::uint32_t{0x0052494e}, type, node,
          header_bytes + static_cast<std::uint32_t>(fields.size()),
          static_cast<std::uint32_t>(payload.size()), std::uint32_t{0}})
      put(bytes, number);
    if (!options_.old_positions) put(bytes, std::uint32_t{0});
    put_all(bytes, fields);
    put_all(bytes, payload);
  }

  void node(std::uint32_t id, const std::string& name, std::uint32_t kind,
            const std::string& codec) {
    Bytes fields = text(name);
    put(fields, kind);
    fields.insert(fields.end(), codec.begin(), codec.end());
    put(fields, ~std::uint32_t{0});
    put(fields, std::uint64_t{0});
    put(fields, ~std::uint64_t{0});
    record(0x0c, id, fields);
  }

  template <class Value>
  void property(std::uint32_t node, const std::string& name, const Value& value) {
    Bytes fields = text(name);
    put(fields, static_cast<std::uint32_t>(sizeof value));
    put(fields, value);
    record(std::is_integral_v<Value> ? 0x03 : 0x06, node, fields);
  }

  void image(std::uint32_t node, std::uint64_t stamp_us, std::uint32_t number,
             const Bytes& payload) {
    Bytes fields;
    put(fields, stamp_us);
    put(fields, number);
    record(0x0a, node, fields, payload);
  }

  Bytes bytes;

 private:
  static Bytes text(const std::string& text) {
    Bytes field;
    put(field, static_cast<std::uint32_t>(text.size() + 1));
    field.insert(field.end(), text.begin(), text.end());
    field.push_back(0);
    return field;
  }

  const OniOptions options_;
};

template <class Pixel>
Image<Pixel> as_in_a_mirror(const Image<Pixel>& image) {
  Image<Pixel> mirrored(image.width, image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) mirrored.at(x, y) = image.at(image.width - 1 - x, y);
  return mirrored;
}

inline Bytes oni_depth(const DepthImage& depth, const std::string& codec) {
  if (codec == "16zP") return nibble_bytes(depth.pixels);
  if (codec == "16zT") return nibble_bytes_with_table(depth.pixels);
  return raw_depth(depth);
}

inline void describe_stream(OniWriter& writer, std::uint32_t node, const Camera& camera, int factor,
                            const OniOptions& options) {
  writer.property(node, "xnIsGenerating", std::uint64_t{1});
  writer.property(
      node, "xnMapOutputMode",
      std::array<std::uint32_t, 3>{static_cast<std::uint32_t>(camera.width * factor),
                                   static_cast<std::uint32_t>(camera.height * factor), 30});
  if (options.has_view)
    writer.property(node, "xnFOV",
                    std::array<double, 2>{2 * std::atan(0.5 * camera.width / camera.fx),
                                          2 * std::atan(0.5 * camera.height / camera.fy)});
  writer.property(node, "xnMirror", std::uint64_t{options.mirrored});
  writer.property(node, "xnCropping",
                  std::array<std::uint16_t, 5>{options.cropped, 10, 10, 40, 40});
}

// Of the first frames of the sequence, at most `frame_limit`.
inline Bytes oni_bytes(const dataset::Sequence& sequence, const OniOptions& options = {},
                       std::int64_t frame_limit = INT64_MAX) {
  OniWriter writer(options);
  writer.node(1, "Depth1", 2, options.depth_codec);
  describe_stream(writer, 1, sequence.camera(), 1, options);
  writer.property(1, "oniPixelFormat", options.oni_pixel_format);
  writer.node(3, "Infrared", 5, "NONE");
  if (options.has_color) {
    writer.node(2, "Image1", 3, options.color_codec);
    describe_stream(writer, 2, sequence.camera(), options.color_factor, options);
    writer.property(2, "xnPixelFormat", std::uint64_t{1});
    writer.property(2, "oniPixelFormat", std::uint64_t{200});
  }
  for (const std::uint32_t node : {1u, 2u}) writer.record(0x09, node);
  const double zero_s = options.streams_from_zero ? 0 : 1000;
  double color_zero_s = zero_s;
  for (std::int64_t i = 0; i < std::min(sequence.frame_count(), frame_limit); ++i) {
    const frame::RgbdFrame frame = frame_of(sequence, i);
    const auto stamp_us = [&](double from_s) {
      return static_cast<std::uint64_t>(std::llround((from_s + frame.timestamp_s) * 1e6));
    };
    const double first_s = sequence.timestamp_s(0);
    writer.image(1, stamp_us(zero_s - first_s), static_cast<std::uint32_t>(i + 1),
                 oni_depth(options.mirrored ? as_in_a_mirror(frame.depth) : frame.depth,
                           options.depth_codec));
    writer.image(3, stamp_us(zero_s - first_s), static_cast<std::uint32_t>(i + 1), Bytes(7, 7));
    if (!options.has_color || i < options.color_frames_late) continue;
    if (i == options.color_frames_late && options.streams_from_zero)
      color_zero_s = -(frame.timestamp_s - first_s);
    const ColorImage color = enlarged(options.mirrored ? as_in_a_mirror(frame.color) : frame.color,
                                      options.color_factor);
    writer.image(2, stamp_us(color_zero_s - first_s),
                 static_cast<std::uint32_t>(i + 1 - options.color_frames_late),
                 options.color_codec == "JPEG" ? *image::encode_jpeg(color, 95) : raw_color(color));
  }
  for (const std::uint32_t node : {1u, 2u}) {
    writer.record(0x07, node);
    writer.record(0x0e, node, {},
                  Bytes(20 * static_cast<std::size_t>(sequence.frame_count() + 1), 1));
  }
  if (options.has_end) writer.record(0x0b, 0);
  return writer.bytes;
}

}  // namespace hermite::test
