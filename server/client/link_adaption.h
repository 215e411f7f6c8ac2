// Reduces what a live camera sends over a link that is too slow for all of it: first the quality of
// colour, then the number of frames. Depth stays lossless. A pure function of the counts of each
// second; uses no clock and no socket.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace hermite::client {

struct LinkLevel {
  // std::nullopt: colour as the camera or the recording provides it.
  std::optional<int> jpeg_quality;
  // Frames sent of `of_frames` consecutive ones; the others are not sent and do not count as
  // dropped.
  int kept_frames = 1;
  int of_frames = 1;
};

// Number of levels.
inline constexpr int kLinkLevels = 7;

// Returns a level; 0 is the best. At 30 Hz the frame rates are 30, 20, 15 and 10 Hz. Tracking needs
// at least a third of the frames.
LinkLevel link_level(int level);  // 0 to kLinkLevels - 1 (CHECK)
// Like "colour q70, 2 of 3 frames"; empty for the first level.
std::string as_text(const LinkLevel& level);

// Counts of one second, without frames that the level left out.
struct LinkCounts {
  std::uint64_t due = 0;
  std::uint64_t dropped = 0;  // of these, because the link was too slow
};

struct LinkState {
  int level = 0;
  int calm_s = 0;         // seconds without a drop, on this level
  int patience_s = 5;     // calm_s required to try the next better level
  bool on_trial = false;  // the level was just raised and has not proved itself yet
};

// If more than a tenth was dropped, switches to the next worse level immediately; if nothing was
// dropped for `patience_s`, to the next better one. In between nothing changes, so that a link that
// is just good enough is left alone. A better level that fails while on trial doubles the patience,
// up to a minute; one that holds resets it.
LinkState after_a_second(LinkState state, const LinkCounts& counts);

}  // namespace hermite::client
