#include "server/client/link_adaption.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "core/base/check.h"

namespace hermite::client {
namespace {

// Quality 90 gains nothing for a recording with such JPEGs, but much for one with PNGs.
constexpr std::array<LinkLevel, kLinkLevels> kLevels{{
    {std::nullopt, 1, 1},
    {90, 1, 1},
    {80, 1, 1},
    {70, 1, 1},
    {70, 2, 3},
    {70, 1, 2},
    {70, 1, 3},
}};

constexpr int kFirstPatience_s = LinkState{}.patience_s;
constexpr int kMaxPatience_s = 60;
constexpr int kTrial_s = 5;
constexpr std::uint64_t kToleratedDrops = 10;  // one in this many

}  // namespace

LinkLevel link_level(int level) {
  CHECK(level >= 0 && level < kLinkLevels, "there is no such level");
  return kLevels[static_cast<std::size_t>(level)];
}

std::string as_text(const LinkLevel& level) {
  if (!level.jpeg_quality) return {};
  const std::string color = fmt::format("colour q{}", *level.jpeg_quality);
  if (level.kept_frames == level.of_frames) return color;
  return fmt::format("{}, {} of {} frames", color, level.kept_frames, level.of_frames);
}

LinkState after_a_second(LinkState state, const LinkCounts& counts) {
  if (counts.due == 0) return state;  // a paused camera says nothing about the link
  if (counts.dropped * kToleratedDrops > counts.due) {
    const int patience_s =
        state.on_trial ? std::min(2 * state.patience_s, kMaxPatience_s) : state.patience_s;
    return {.level = std::min(state.level + 1, kLinkLevels - 1),
            .calm_s = 0,
            .patience_s = patience_s,
            .on_trial = false};
  }
  if (counts.dropped > 0) {
    state.calm_s = 0;
    return state;
  }
  ++state.calm_s;
  if (state.on_trial && state.calm_s >= kTrial_s) {
    state.on_trial = false;
    state.patience_s = kFirstPatience_s;
  }
  if (state.level > 0 && state.calm_s >= state.patience_s)
    return {
        .level = state.level - 1, .calm_s = 0, .patience_s = state.patience_s, .on_trial = true};
  return state;
}

}  // namespace hermite::client
