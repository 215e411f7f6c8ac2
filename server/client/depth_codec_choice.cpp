#include "server/client/depth_codec_choice.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "proto/wire/frame_payload.h"

namespace hermite::client {
namespace {

using Clock = std::chrono::steady_clock;

// Sizes of frames of the same sensor differ less than those of codecs.
constexpr std::int64_t kTrialFrames = 3;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<DepthCodecTrial> try_depth_codecs(const std::vector<DepthImage>& frames) {
  std::vector<DepthCodecTrial> trials;
  for (const wire::DepthCodec codec : wire::kDepthCodecs) {
    DepthCodecTrial trial{codec, 0, 0};
    std::vector<double> times_ms;
    for (const DepthImage& frame : frames) {
      const auto start = Clock::now();
      const Result<std::string> payload = wire::encode_depth_payload(frame, codec);
      times_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      CHECK(payload.ok(), "depth of a readable frame can be encoded");
      trial.bytes += payload->size();
    }
    if (!times_ms.empty()) trial.encode_ms = median(std::move(times_ms));
    trials.push_back(trial);
  }
  return trials;
}

std::vector<wire::DepthCodec> best_first(std::vector<DepthCodecTrial> trials, double budget_ms) {
  std::stable_sort(trials.begin(), trials.end(),
                   [budget_ms](const DepthCodecTrial& a, const DepthCodecTrial& b) {
                     const bool a_fits = a.encode_ms <= budget_ms,
                                b_fits = b.encode_ms <= budget_ms;
                     if (a_fits != b_fits) return a_fits;
                     return a_fits ? a.bytes < b.bytes : a.encode_ms < b.encode_ms;
                   });
  std::vector<wire::DepthCodec> codecs;
  for (const DepthCodecTrial& trial : trials) codecs.push_back(trial.codec);
  return codecs;
}

std::vector<wire::DepthCodec> depth_codecs_for(const dataset::Sequence& sequence,
                                               const dataset::FrameRange& range) {
  std::vector<DepthImage> frames;
  const std::int64_t count = std::min(range.count(), kTrialFrames);
  for (std::int64_t k = 0; k < count; ++k) {
    Result<dataset::RecordedFrame> frame =
        sequence.read(range.begin + (2 * k + 1) * range.count() / (2 * count));
    if (frame.ok()) frames.push_back(std::move(frame->depth));
  }
  return best_first(try_depth_codecs(frames), 1000 / sequence.frame_rate_hz() / 3);
}

}  // namespace hermite::client
