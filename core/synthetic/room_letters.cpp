#include "core/synthetic/room_letters.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

namespace hermite::synthetic {
namespace {

using Eigen::Vector2f;

// In twelfths of a capital's height.
constexpr float kHalfStroke = 0.8f, kBetweenLetters = 3.6f, kBetweenWords = 8.0f;

// Polylines of A to Z: each point is two digits from 0 to c, to the right and up.
constexpr std::string_view kStrokes[] = {
    "004c80 2464",                           // A
    "000c5c7b8a87765606 56758482715000",     // B
    "8a7b5c3c1b09031130507182",              // C
    "000c4c6b8983614000",                    // D
    "7c0c0070 0666",                         // E
    "7c0c00 0656",                           // F
    "8a7b5c3c1b0903113050718286 8656",       // G
    "000c 808c 0686",                        // H
    "000c",                                  // I
    "6c635140201103",                        // J
    "000c 8c04 3780",                        // K
    "0c0070",                                // L
    "000c408c80",                            // M
    "000c808c",                              // N
    "301103091b3c5c7b8983715030",            // O
    "000c5c7b8a87765505",                    // P
    "301103091b3c5c7b8983715030 4480",       // Q
    "000c5c7b8a87765505 4580",               // R
    "8a7b5c3c1b0a081736567584827150301102",  // S
    "0c8c 4c40",                             // T
    "0c0311305071838c",                      // U
    "0c408c",                                // V
    "0c305b80ac",                            // W
    "008c 0c80",                             // X
    "0c468c 4640",                           // Y
    "0c8c0080",                              // Z
};

struct Segment {
  Vector2f from, to;
};

// A letter or line, relative to its start on the baseline, in twelfths of a capital's height.
struct Letter {
  std::vector<Segment> segments;
  float left = 0, right = 0;
};

float digit(char c) { return static_cast<float>(c <= '9' ? c - '0' : c - 'a' + 10); }

// `left` is where the letter begins; on return, where the next one does.
Letter letter_of(char c, float& left) {
  Letter letter{{}, left, left};
  const std::string_view strokes = kStrokes[c - 'A'];
  for (std::size_t i = 0; i + 4 <= strokes.size(); i += 2) {
    if (strokes[i + 2] == ' ') {
      ++i;
      continue;
    }
    const Vector2f from(left + digit(strokes[i]), digit(strokes[i + 1])),
        to(left + digit(strokes[i + 2]), digit(strokes[i + 3]));
    letter.segments.push_back({from, to});
    letter.right = std::max({letter.right, from.x(), to.x()});
  }
  left = letter.right + kBetweenLetters;
  return letter;
}

// Returns the letters from left to right, with the middle of the line at 0.
std::vector<Letter> letters_of(std::string_view words) {
  std::vector<Letter> letters;
  float left = 0;
  for (const char c : words) {
    if (c == ' ')
      left += kBetweenWords;
    else
      letters.push_back(letter_of(c, left));
  }
  const float middle = (left - kBetweenLetters) / 2;
  for (Letter& letter : letters) {
    letter.left -= middle;
    letter.right -= middle;
    for (Segment& segment : letter.segments) {
      segment.from.x() -= middle;
      segment.to.x() -= middle;
    }
  }
  return letters;
}

float distance_to_stroke(const Segment& segment, const Vector2f& point) {
  const Vector2f way = segment.to - segment.from;
  const float share = std::clamp((point - segment.from).dot(way) / way.squaredNorm(), 0.0f, 1.0f);
  return (segment.from + share * way - point).norm();
}

// Returns the share of a footprint, at this distance from the middle of a stroke, that the stroke
// covers; exact across a straight one.
float share_under_stroke(float distance_from_middle, float footprint) {
  const float half = 0.5f * std::max(footprint, 1e-3f);
  const float low = std::max(distance_from_middle - half, -kHalfStroke),
              high = std::min(distance_from_middle + half, kHalfStroke);
  return std::max(high - low, 0.0f) / (2 * half);
}

struct SetLine {
  std::vector<Letter> letters;
  float unit_m, baseline_m;
};

const std::vector<SetLine>& set_lines() {
  static const std::vector<SetLine> kLines = [] {
    std::vector<SetLine> lines;
    for (const PosterLine& line : kPosterLines)
      lines.push_back({letters_of(line.words), line.cap_height_m / 12, line.baseline_m});
    return lines;
  }();
  return kLines;
}

}  // namespace

float ink_of_poster(const TexturePoint& point) {
  float ink = 0;
  for (const SetLine& line : set_lines()) {
    const Vector2f place(point.u_m / line.unit_m, (point.v_m - line.baseline_m) / line.unit_m);
    const float footprint = point.footprint_m / line.unit_m, reach = kHalfStroke + footprint;
    if (place.y() < -reach || place.y() > 12 + reach) continue;
    for (const Letter& letter : line.letters) {
      if (place.x() < letter.left - reach || place.x() > letter.right + reach) continue;
      float nearest = std::numeric_limits<float>::max();
      for (const Segment& segment : letter.segments)
        nearest = std::min(nearest, distance_to_stroke(segment, place));
      ink = std::max(ink, share_under_stroke(nearest, footprint));
    }
  }
  return ink;
}

}  // namespace hermite::synthetic
