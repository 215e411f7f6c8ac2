#include "server/client/frame_encoder.h"

#include <fmt/core.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/image/image_codec.h"
#include "proto/wire/frame_payload.h"
#include "server/client/depth_codec_choice.h"

namespace hermite::client {
namespace {

std::string as_text(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

// Bytes that may be sent as they are but cannot be decoded are left to the server, which decodes
// with the same functions as a run without a server.
Result<std::string> encode_color(const std::vector<std::uint8_t>& recorded, image::ImageSize size,
                                 const WireEncoding& encoding) {
  const auto format = image::detect_image_format(recorded);
  const bool must_change =
      !encoding.png_color && format.ok() && *format == image::ImageFormat::kPng;
  if (!format.ok() || (!must_change && !encoding.jpeg_quality)) return as_text(recorded);
  const auto image = image::decode_color(recorded, size);
  if (!image.ok() && must_change) return image.error();
  if (!image.ok()) return as_text(recorded);
  const auto jpeg = image::encode_jpeg(*image, encoding.jpeg_quality.value_or(kJpegQuality));
  if (!jpeg.ok()) return jpeg.error();
  return as_text(must_change || jpeg->size() < recorded.size() ? *jpeg : recorded);
}

Status encode_recording(const dataset::Sequence& sequence, const WireEncoding& encoding,
                        EncodedFrame& encoded) {
  const auto recorded = sequence.read(encoded.index);
  if (!recorded.ok()) return recorded.error();
  const image::ImageSize size{sequence.camera().width, sequence.camera().height};
  auto depth = wire::encode_depth_payload(recorded->depth, encoding.depth);
  if (!depth.ok()) return in_context("depth", depth.error());
  auto color = encode_color(recorded->color_bytes, size, encoding);
  if (!color.ok()) return in_context("colour", color.error());
  encoded.frame.depth = *std::move(depth);
  encoded.frame.color = *std::move(color);
  encoded.frame.acceleration_m_s2 = recorded->acceleration_m_s2;
  return Done{};
}

// JPEG preserves black exactly, so the server's pipeline gets wire::empty_frame.
void encode_black(const Camera& camera, const WireEncoding& encoding, EncodedFrame& encoded) {
  const frame::RgbdFrame black = wire::empty_frame(encoded.frame.timestamp_s, camera);
  auto depth = wire::encode_depth_payload(black.depth, encoding.depth);
  const auto color = image::encode_jpeg(black.color, kJpegQuality);
  CHECK(depth.ok() && color.ok(), "a black image of a valid camera can be encoded");
  encoded.frame.depth = *std::move(depth);
  encoded.frame.color = as_text(*color);
}

}  // namespace

EncodedFrame encode_frame(const dataset::Sequence& sequence, std::int64_t index,
                          const WireEncoding& encoding) {
  EncodedFrame encoded;
  encoded.index = index;
  encoded.frame.timestamp_s = sequence.timestamp_s(index);
  const Status status = encode_recording(sequence, encoding, encoded);
  if (!status.ok()) {
    encoded.problem = fmt::format("frame {}: {}", index, status.error().message);
    encode_black(sequence.camera(), encoding, encoded);
  }
  return encoded;
}

std::vector<wire::DepthCodec> RecordedFrames::depth_codecs() const {
  return depth_codecs_for(sequence_, range_);
}

Supply RecordedFrames::next(const WireEncoding& encoding, EncodedFrame& frame) {
  if (next_ >= range_.end) return Supply::kEnd;
  frame = encode_frame(sequence_, next_++, encoding);
  return Supply::kFrame;
}

struct FrameEncoder::Worker {
  Worker(FrameSource& frames, const Settings& wanted, std::function<void()> notify)
      : source(frames), settings(wanted), on_ready(std::move(notify)) {
    CHECK(settings.read_ahead > 0, "an encoder that may hold no frame never ends");
    thread = std::thread([this] { run(); });
  }

  ~Worker() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    room_or_stop.notify_all();
    thread.join();
  }

  void run() {
    for (bool ended = false; !ended;) {
      {
        std::unique_lock lock(mutex);
        room_or_stop.wait(lock, [this] { return stopping || ready.size() < settings.read_ahead; });
        if (stopping) return;
      }
      WireEncoding encoding = settings.encoding;
      if (const int quality = jpeg_quality.load(); quality != 0) encoding.jpeg_quality = quality;
      EncodedFrame frame;
      const Supply supply = source.next(encoding, frame);
      ended = supply == Supply::kEnd;
      if (supply == Supply::kNotYet) continue;
      {
        const std::lock_guard lock(mutex);
        if (supply == Supply::kFrame) ready.push_back(std::move(frame));
        at_end = ended;
      }
      on_ready();
    }
  }

  FrameSource& source;
  const Settings settings;
  const std::function<void()> on_ready;
  std::atomic<int> jpeg_quality{0};  // 0: unset

  std::mutex mutex;
  std::condition_variable room_or_stop;
  std::deque<EncodedFrame> ready;  // guarded by mutex
  bool at_end = false;             // guarded by mutex: the source has no more frames
  bool stopping = false;           // guarded by mutex
  std::thread thread;
};

FrameEncoder::FrameEncoder(FrameSource& source, const Settings& settings,
                           std::function<void()> on_ready)
    : worker_(std::make_unique<Worker>(source, settings, std::move(on_ready))) {}

FrameEncoder::~FrameEncoder() = default;

std::optional<EncodedFrame> FrameEncoder::take() {
  std::optional<EncodedFrame> frame;
  {
    const std::lock_guard lock(worker_->mutex);
    if (worker_->ready.empty()) return std::nullopt;
    frame = std::move(worker_->ready.front());
    worker_->ready.pop_front();
  }
  worker_->room_or_stop.notify_one();
  return frame;
}

void FrameEncoder::set_jpeg_quality(std::optional<int> quality) {
  worker_->jpeg_quality = quality.value_or(0);
}

bool FrameEncoder::exhausted() const {
  const std::lock_guard lock(worker_->mutex);
  return worker_->at_end && worker_->ready.empty();
}

}  // namespace hermite::client
