// hermite_codec_bench SOURCE...: what the depth codecs make of recordings, as Markdown tables for
// tests/bench/README.md. A SOURCE is what `hermite reconstruct` takes; behind "mm:" its depth is
// rounded to millimetres first. At most 100 frames of each, evenly spread. Fails when a frame does
// not come back as it was. Times are of the processor, the median of the frames, so that a busy
// machine disturbs little.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "core/image/depth_codec.h"
#include "core/image/depth_ranks.h"
#include "core/image/image_codec.h"
#include "core/image/rank_dictionary.h"
#include "core/source/open_sequence.h"

namespace hermite {
namespace {

constexpr std::int64_t kMaxFrames = 100;
constexpr double kRate_hz = 30;  // of a live camera, for Mbit/s
constexpr int kColorQuality = 85;
constexpr const char* kMillimetres = "mm:";

using Bytes = std::vector<std::uint8_t>;

struct Codec {
  const char* name;
  std::function<Bytes(const DepthImage&)> encode;
  std::function<Result<DepthImage>(const Bytes&, image::ImageSize)> decode;
};

Bytes encode_plain_rvl(const DepthImage& depth) {
  const std::vector<std::uint32_t> words = image::encode_rvl(depth.pixels);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(words.data());
  return {bytes, bytes + words.size() * sizeof(std::uint32_t)};
}

Result<DepthImage> decode_plain_rvl(const Bytes& bytes, image::ImageSize size) {
  DepthImage depth(size.width, size.height);
  const Status status = image::decode_rvl(
      {reinterpret_cast<const std::uint32_t*>(bytes.data()), bytes.size() / sizeof(std::uint32_t)},
      depth.pixels);
  if (!status.ok()) return status.error();
  return depth;
}

const std::vector<Codec>& codecs() {
  static const std::vector<Codec> table{
      {"PNG16", [](const DepthImage& depth) { return or_throw(image::encode_depth_png(depth)); },
       image::decode_depth_png},
      {"RVL", encode_plain_rvl, decode_plain_rvl},
      {"RVL + zstd", image::encode_depth_rvl_zstd, image::decode_depth_rvl_zstd},
      {"ranks", image::encode_depth_ranks, image::decode_depth_ranks},
  };
  return table;
}

double processor_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

struct Measured {
  std::size_t bytes = 0;
  std::vector<double> encode_ms, decode_ms;  // a frame
};

struct Measurement {
  std::int64_t frame_count = 0;
  std::size_t pixel_count = 0;  // of all frames
  std::vector<Measured> depth;  // as codecs()
  Measured color;
  std::size_t dictionary_bits = 0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void measure_depth(const DepthImage& depth, const Codec& codec, Measured& measured) {
  const double start = processor_ms();
  const Bytes bytes = codec.encode(depth);
  const double encoded = processor_ms();
  const DepthImage back = or_throw(codec.decode(bytes, {depth.width, depth.height}));
  const double decoded = processor_ms();
  if (back != depth)
    throw SetupError(
        {ErrorCode::kCorruptData, std::string(codec.name) + " gives back another image"});
  measured.bytes += bytes.size();
  measured.encode_ms.push_back(encoded - start);
  measured.decode_ms.push_back(decoded - encoded);
}

void measure_color(const ColorImage& color, Measured& measured) {
  const double start = processor_ms();
  measured.bytes += or_throw(image::encode_jpeg(color, kColorQuality)).size();
  measured.encode_ms.push_back(processor_ms() - start);
}

Measurement measure(const dataset::Sequence& sequence, bool to_millimetres) {
  Measurement measurement;
  measurement.depth.resize(codecs().size());
  const std::int64_t count = std::min(sequence.frame_count(), kMaxFrames);
  for (std::int64_t k = 0; k < count; ++k) {
    frame::RgbdFrame frame = or_throw(
        dataset::decode_frame(or_throw(sequence.read(k * sequence.frame_count() / count))));
    if (to_millimetres) {
      const double scale = 1000 / sequence.camera().depth_units_per_metre;
      for (std::uint16_t& pixel : frame.depth.pixels)
        pixel = static_cast<std::uint16_t>(scale * pixel + 0.5);
    }
    for (std::size_t i = 0; i < codecs().size(); ++i)
      measure_depth(frame.depth, codecs()[i], measurement.depth[i]);
    measure_color(frame.color, measurement.color);
    image::BitWriter dictionary;
    image::write_rank_dictionary(image::find_rank_dictionary(frame.depth.pixels), dictionary);
    measurement.dictionary_bits += 8 * std::move(dictionary).finish().size();
    measurement.frame_count += 1;
    measurement.pixel_count += frame.depth.pixels.size();
  }
  return measurement;
}

void print_row(const std::string& source, const char* codec, const Measured& measured,
               const Measurement& measurement) {
  const double bits = 8 * static_cast<double>(measured.bytes);
  std::printf("| %s | %s | %.2f | %.1f | %.1f | %s |\n", source.c_str(), codec,
              bits / static_cast<double>(measurement.pixel_count),
              bits / static_cast<double>(measurement.frame_count) * kRate_hz * 1e-6,
              median(measured.encode_ms),
              measured.decode_ms.empty()
                  ? ""
                  : std::to_string(median(measured.decode_ms)).substr(0, 3).c_str());
}

void print_source(const std::string& source) {
  const bool to_millimetres = source.starts_with(kMillimetres);
  const auto sequence = or_throw(source::open_sequence(
      to_millimetres ? source.substr(std::string(kMillimetres).size()) : source));
  const Measurement measurement = measure(*sequence, to_millimetres);
  std::string name = source.substr(source.find_last_of('/') + 1);
  if (to_millimetres) name += ", in mm";
  for (std::size_t i = 0; i < codecs().size(); ++i)
    print_row(name, codecs()[i].name, measurement.depth[i], measurement);
  print_row(name, "colour, JPEG q85", measurement.color, measurement);

  Measured both = measurement.depth.back();
  both.bytes += measurement.color.bytes;
  both.decode_ms.clear();
  for (std::size_t k = 0; k < both.encode_ms.size(); ++k)
    both.encode_ms[k] += measurement.color.encode_ms[k];
  print_row(name, "ranks and colour", both, measurement);
  std::fprintf(stderr, "%s: %lld frames, the dictionary takes %.4f bit/px\n", name.c_str(),
               static_cast<long long>(measurement.frame_count),
               static_cast<double>(measurement.dictionary_bits) /
                   static_cast<double>(measurement.pixel_count));
}

}  // namespace
}  // namespace hermite

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: hermite_codec_bench [mm:]SOURCE...\n");
    return 2;
  }
  try {
    std::printf(
        "| sequence | codec | bit/px | Mbit/s at 30 Hz | encode [ms] | decode [ms] "
        "|\n|---|---|---|---|---|---|\n");
    for (int i = 1; i < argc; ++i) hermite::print_source(argv[i]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hermite_codec_bench: %s\n", error.what());
    return 1;
  }
}
