#include "core/source/open_sequence.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/dataset/recording.h"
#include "core/dataset/text_file.h"
#include "core/disturb/color_disturbance.h"
#include "core/disturb/depth_disturbance.h"
#include "core/disturb/depth_noise.h"
#include "core/disturb/disturbance.h"
#include "core/disturb/held_disturbance.h"
#include "core/disturb/lens_disturbance.h"
#include "core/disturb/light_disturbance.h"
#include "core/disturb/moving_person.h"
#include "core/disturb/pane_disturbance.h"
#include "core/disturb/rig_disturbance.h"
#include "core/disturb/sensor_disturbance.h"
#include "core/disturb/shutter_disturbance.h"
#include "core/synthetic/synthetic_camera.h"

namespace hermite::source {
namespace {

constexpr std::string_view kSynthetic = "synthetic";

bool is_recorded(const std::string& path) {
  return dataset::is_folder(path) || dataset::is_file(path);
}

Result<std::unique_ptr<dataset::Sequence>> open_synthetic(const std::string& source,
                                                          const std::optional<Camera>& camera) {
  const bool has_options = source.size() > kSynthetic.size();
  Result<synthetic::SyntheticOptions> options =
      synthetic::parse_synthetic_options(has_options ? source.substr(kSynthetic.size() + 1) : "");
  if (!options.ok()) return in_context(fmt::format("source \"{}\"", source), options.error());
  if (camera) options->camera = *camera;
  return synthetic::make_synthetic_sequence(*options);
}

using Opened = Result<std::unique_ptr<dataset::Sequence>>;

Opened noisy(std::unique_ptr<dataset::Sequence> sequence, const std::string& text) {
  const Result<disturb::NoiseOptions> noise = disturb::parse_noise(text);
  if (!noise.ok()) return noise.error();
  return disturb::with_noise(std::move(sequence), *noise);
}

Opened covered(std::unique_ptr<dataset::Sequence> sequence, const std::string& text) {
  const Result<disturb::FrameSpan> span = disturb::parse_frame_span(text);
  if (!span.ok()) return in_context("covered", span.error());
  return disturb::with_covered(std::move(sequence), *span);
}

Opened missing(std::unique_ptr<dataset::Sequence> sequence, const std::string& text) {
  const Result<disturb::FrameSpan> span = disturb::parse_frame_span(text);
  if (!span.ok()) return in_context("missing", span.error());
  return disturb::with_missing(std::move(sequence), *span);
}

struct SuffixKind {
  std::string_view name;  // "+name=TEXT"; an empty text may go without the "="
  Opened (*apply)(std::unique_ptr<dataset::Sequence> sequence, const std::string& text);
};
constexpr SuffixKind kSuffixKinds[] = {{"+noise", noisy},
                                       {"+covered", covered},
                                       {"+missing", missing},
                                       {"+exposure", disturb::with_exposure},
                                       {"+flicker", disturb::with_flicker},
                                       {"+vignetting", disturb::with_vignetting},
                                       {"+person", disturb::with_person},
                                       {"+bend", disturb::with_bend},
                                       {"+sparse", disturb::with_sparse},
                                       {"+reach", disturb::with_reach},
                                       {"+focal", disturb::with_focal},
                                       {"+skip", disturb::with_skip},
                                       {"+lens", disturb::with_lens},
                                       {"+rolling", disturb::with_rolling},
                                       {"+clock", disturb::with_clock},
                                       {"+blur", disturb::with_blur},
                                       {"+mirror", disturb::with_mirror},
                                       {"+glass", disturb::with_glass},
                                       {"+flying", disturb::with_flying},
                                       {"+lowres", disturb::with_lowres},
                                       {"+speckle", disturb::with_speckle},
                                       {"+frozen", disturb::with_frozen},
                                       {"+misregistered", disturb::with_misregistered},
                                       {"+banding", disturb::with_banding},
                                       {"+dark", disturb::with_dark},
                                       {"+screen", disturb::with_screen},
                                       {"+door", disturb::with_door},
                                       {"+headlamp", disturb::with_headlamp},
                                       {"+lamp", disturb::with_lamp},
                                       {"+sun", disturb::with_sun},
                                       {"+balance", disturb::with_balance},
                                       {"+attached", disturb::with_attached},
                                       {"+torn", disturb::with_torn},
                                       {"+stained", disturb::with_stained},
                                       {"+warming", disturb::with_warming},
                                       {"+jitter", disturb::with_jitter},
                                       {"+turned", disturb::with_turned},
                                       {"+accelerometer", disturb::with_accelerometer}};
// Each disturbance is a layer around the sequence through which every read passes.
constexpr std::size_t kMaxSuffixes = 16;

struct Suffix {
  const SuffixKind* kind = nullptr;  // nullptr: the source does not end with a suffix
  std::size_t begin = 0;
  std::string text;  // after the "="
};

// Returns where the last suffix of that kind begins.
std::size_t last_of_kind(const std::string& source, std::string_view name) {
  std::size_t begin = source.rfind(name);
  const auto is_whole = [&] {
    const std::size_t end = begin + name.size();
    return end == source.size() || source[end] == '=';
  };
  while (begin != std::string::npos && !is_whole())
    begin = begin > 0 ? source.rfind(name, begin - 1) : std::string::npos;
  return begin;
}

Suffix last_suffix(const std::string& source) {
  Suffix last;
  for (const SuffixKind& kind : kSuffixKinds)
    if (const std::size_t begin = last_of_kind(source, kind.name);
        begin != std::string::npos && (!last.kind || begin > last.begin))
      last = {&kind, begin, source.substr(std::min(begin + kind.name.size() + 1, source.size()))};
  return last;
}

Opened open_base(const std::string& source, const std::optional<Camera>& camera) {
  if (is_recorded(source)) {
    Result<dataset::Recording> recording = dataset::open_recording(source, camera);
    if (!recording.ok()) return recording.error();
    return std::move(recording->sequence);
  }
  if (source == kSynthetic || source.rfind(std::string(kSynthetic) + ":", 0) == 0)
    return open_synthetic(source, camera);
  return Error{
      ErrorCode::kNotFound,
      fmt::format("\"{}\" is neither a file, a folder nor synthetic[:key=value,...]", source)};
}

}  // namespace

std::string source_without_suffixes(const std::string& source) {
  std::string base = source;
  while (!is_recorded(base)) {
    const Suffix suffix = last_suffix(base);
    if (!suffix.kind) break;
    base.resize(suffix.begin);
  }
  return base;
}

Result<std::unique_ptr<dataset::Sequence>> open_sequence(const std::string& source,
                                                         const std::optional<Camera>& camera) {
  if (camera)
    if (const Status status = validate(*camera); !status.ok()) return status.error();
  std::string base = source;
  std::vector<Suffix> suffixes;  // from right to left
  while (!is_recorded(base)) {
    Suffix suffix = last_suffix(base);
    if (!suffix.kind) break;
    base.resize(suffix.begin);
    suffixes.push_back(std::move(suffix));
    if (suffixes.size() > kMaxSuffixes)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("more than {} disturbances behind a source", kMaxSuffixes)};
  }
  Opened opened = open_base(base, camera);
  for (auto suffix = suffixes.rbegin(); suffix != suffixes.rend() && opened.ok(); ++suffix) {
    opened = suffix->kind->apply(std::move(*opened), suffix->text);
    if (!opened.ok()) return in_context(fmt::format("source \"{}\"", source), opened.error());
  }
  return opened;
}

}  // namespace hermite::source
