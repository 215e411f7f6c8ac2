#include "core/source/open_sequence.h"

#include <algorithm>

#include "core/dataset/recording.h"
#include "core/dataset/text_file.h"
#include "core/disturb/color_disturbance.h"
#include "core/disturb/depth_disturbance.h"
#include "core/disturb/depth_noise.h"
#include "core/disturb/disturbance.h"
#include "core/disturb/light_disturbance.h"
#include "core/disturb/moving_person.h"
#include "core/disturb/pane_disturbance.h"
#include "core/disturb/rig_disturbance.h"
#include "core/disturb/sensor_disturbance.h"
#include "core/disturb/shutter_disturbance.h"
#include "core/synthetic/synthetic_camera.h"

namespace hermite {
namespace {

constexpr std::string_view kSynthetic = "synthetic";

bool is_recorded(const std::string& path) { return is_folder(path) || is_file(path); }

Result<std::unique_ptr<Sequence>> open_synthetic(const std::string& source, const std::optional<Camera>& camera) {
  const bool has_options = source.size() > kSynthetic.size();
  Result<SyntheticOptions> options = parse_synthetic_options(has_options ? source.substr(kSynthetic.size() + 1) : "");
  if (!options.ok()) return in_context("source \"" + source + "\"", options.error());
  if (camera) options->camera = *camera;
  return make_synthetic_sequence(*options);
}

using Opened = Result<std::unique_ptr<Sequence>>;

Opened noisy(std::unique_ptr<Sequence> sequence, const std::string& text) {
  const Result<NoiseOptions> noise = parse_noise(text);
  if (!noise.ok()) return noise.error();
  return with_noise(std::move(sequence), *noise);
}

Opened covered(std::unique_ptr<Sequence> sequence, const std::string& text) {
  const Result<FrameSpan> span = parse_frame_span(text);
  if (!span.ok()) return in_context("covered", span.error());
  return with_covered(std::move(sequence), *span);
}

Opened missing(std::unique_ptr<Sequence> sequence, const std::string& text) {
  const Result<FrameSpan> span = parse_frame_span(text);
  if (!span.ok()) return in_context("missing", span.error());
  return with_missing(std::move(sequence), *span);
}

struct SuffixKind {
  std::string_view name;  // "+name=TEXT"; an empty text may go without the "="
  Opened (*apply)(std::unique_ptr<Sequence> sequence, const std::string& text);
};
constexpr SuffixKind kSuffixKinds[] = {{"+noise", noisy},
                                       {"+covered", covered},
                                       {"+missing", missing},
                                       {"+exposure", with_exposure},
                                       {"+flicker", with_flicker},
                                       {"+vignetting", with_vignetting},
                                       {"+person", with_person},
                                       {"+bend", with_bend},
                                       {"+sparse", with_sparse},
                                       {"+focal", with_focal},
                                       {"+skip", with_skip},
                                       {"+rolling", with_rolling},
                                       {"+clock", with_clock},
                                       {"+blur", with_blur},
                                       {"+mirror", with_mirror},
                                       {"+glass", with_glass},
                                       {"+flying", with_flying},
                                       {"+lowres", with_lowres},
                                       {"+speckle", with_speckle},
                                       {"+frozen", with_frozen},
                                       {"+misregistered", with_misregistered},
                                       {"+banding", with_banding},
                                       {"+dark", with_dark},
                                       {"+screen", with_screen},
                                       {"+door", with_door},
                                       {"+headlamp", with_headlamp},
                                       {"+lamp", with_lamp},
                                       {"+sun", with_sun},
                                       {"+balance", with_balance},
                                       {"+attached", with_attached},
                                       {"+torn", with_torn},
                                       {"+stained", with_stained},
                                       {"+warming", with_warming},
                                       {"+jitter", with_jitter}};
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
  while (begin != std::string::npos && !is_whole()) begin = begin > 0 ? source.rfind(name, begin - 1) : std::string::npos;
  return begin;
}

Suffix last_suffix(const std::string& source) {
  Suffix last;
  for (const SuffixKind& kind : kSuffixKinds)
    if (const std::size_t begin = last_of_kind(source, kind.name); begin != std::string::npos && (!last.kind || begin > last.begin))
      last = {&kind, begin, source.substr(std::min(begin + kind.name.size() + 1, source.size()))};
  return last;
}

Opened open_base(const std::string& source, const std::optional<Camera>& camera) {
  if (is_recorded(source)) {
    Result<Recording> recording = open_recording(source, camera);
    if (!recording.ok()) return recording.error();
    return std::move(recording->sequence);
  }
  if (source == kSynthetic || source.rfind(std::string(kSynthetic) + ":", 0) == 0) return open_synthetic(source, camera);
  return Error{ErrorCode::kNotFound, "\"" + source + "\" is neither a file, a folder nor synthetic[:key=value,...]"};
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

Result<std::unique_ptr<Sequence>> open_sequence(const std::string& source, const std::optional<Camera>& camera) {
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
      return Error{ErrorCode::kInvalidArgument, "more than " + std::to_string(kMaxSuffixes) + " disturbances behind a source"};
  }
  Opened opened = open_base(base, camera);
  for (auto suffix = suffixes.rbegin(); suffix != suffixes.rend() && opened.ok(); ++suffix) {
    opened = suffix->kind->apply(std::move(*opened), suffix->text);
    if (!opened.ok()) return in_context("source \"" + source + "\"", opened.error());
  }
  return opened;
}

}  // namespace hermite
