#include "server/client/load_frames.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "server/client/depth_codec_choice.h"
#include "server/client/frame_encoder.h"

namespace hermite::client {

LoadFrames::LoadFrames(const dataset::Sequence& sequence, std::size_t max_bytes)
    : sequence_(sequence),
      max_bytes_(max_bytes),
      depth_codecs_(depth_codecs_for(sequence, {0, sequence.frame_count()})) {}

EncodedFrame LoadFrames::frame(std::int64_t index, const WireEncoding& encoding) {
  const Key key{index, encoding.depth, encoding.png_color, encoding.jpeg_quality};
  std::promise<std::shared_ptr<const EncodedFrame>> promise;
  Kept kept;
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    const auto found = kept_.find(key);
    if (found != kept_.end()) kept = found->second;
    is_new = found == kept_.end() && kept_bytes_ < max_bytes_;
    if (is_new) kept_.emplace(key, promise.get_future().share());
  }
  if (is_new) return *encode(key, std::move(promise));
  return kept.valid() ? *kept.get() : encode_frame(sequence_, index, encoding);
}

std::shared_ptr<const EncodedFrame> LoadFrames::encode(
    const Key& key, std::promise<std::shared_ptr<const EncodedFrame>> promise) {
  auto encoded = std::make_shared<const EncodedFrame>(
      encode_frame(sequence_, key.index, {key.depth, key.png_color, key.jpeg_quality}));
  promise.set_value(encoded);
  const std::lock_guard lock(mutex_);
  kept_bytes_ += encoded->frame.depth.size() + encoded->frame.color.size();
  return encoded;
}

bool LoadFrames::full() const {
  const std::lock_guard lock(mutex_);
  return kept_bytes_ >= max_bytes_;
}

// The server takes the first codec of the offer, and PNG colour.
void LoadFrames::prepare(std::int64_t count, const std::function<bool(std::int64_t done)>& go_on) {
  const WireEncoding encoding{.depth = depth_codecs_.front()};
  std::mutex telling;
  std::int64_t done = 0;
  bool stopped = false;
  in_parallel(static_cast<std::size_t>(std::min(count, sequence_.frame_count())),
              [&](std::size_t i) {
                {
                  const std::lock_guard lock(telling);
                  if (stopped) return;
                }
                if (full()) return;
                static_cast<void>(frame(static_cast<std::int64_t>(i), encoding));
                const std::lock_guard lock(telling);
                stopped = !go_on(++done) || stopped;
              });
}

std::size_t LoadFrames::kept_count() const {
  const std::lock_guard lock(mutex_);
  return kept_.size();
}

Supply LoadCameraFrames::next(const WireEncoding& encoding, EncodedFrame& frame) {
  if (next_ >= frames_.sequence().frame_count()) return Supply::kEnd;
  frame = frames_.frame(next_++, encoding);
  return Supply::kFrame;
}

}  // namespace hermite::client
