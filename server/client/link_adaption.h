// What a live camera sends over a link that is too slow for all of it: first worse colour, then fewer frames. Depth stays lossless.
// A pure function of what was counted in each second; knows no clock and no socket.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace hermite {

struct LinkLevel {
  std::optional<int> jpeg_quality;  // none: colour as the camera or the recording has it
  int kept_frames = 1;              // of `of_frames` in a row; the others are not sent and are no loss
  int of_frames = 1;
};

// From all to least; at 30 Hz the frames are 30, 20, 15 and 10 a second. A third of the frames is the least that tracking can live on.
inline constexpr int kLinkLevels = 7;
LinkLevel link_level(int level);               // 0 to kLinkLevels - 1 (CHECK)
std::string in_words(const LinkLevel& level);  // "colour q70, 2 of 3 frames"; empty for the first

// Of the frames of one second that the level did not leave out.
struct LinkCounts {
  std::uint64_t due = 0;
  std::uint64_t dropped = 0;  // of these, for want of the link
};

struct LinkState {
  int level = 0;
  int calm_s = 0;         // without a drop, on this level
  int patience_s = 5;     // calm that it takes to try the next better level
  bool on_trial = false;  // the level was just made better and has not yet proved itself
};

// More than a tenth dropped: the next worse level, at once. Nothing dropped for `patience_s`: the next better one. In between nothing
// changes, so that a link just good enough is left alone. A better level that fails while it is on trial doubles the patience, to a minute
// at most; one that holds sets it back.
LinkState after_a_second(LinkState state, const LinkCounts& counts);

}  // namespace hermite
