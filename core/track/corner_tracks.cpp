#include "core/track/corner_tracks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/frame_helpers.h"

namespace hermite::track {

namespace {

// Standard deviation of corner tracking, in pixels of levels[0].
constexpr double kPrecision_px = 0.15;
// Growth of that deviation by drift for each further frame, as a share of it.
constexpr double kDriftPerFrame = 0.1;
// Numbers of frames over which corners are compared, longest first; baselines with too few corners
// are skipped.
constexpr std::size_t kBaselines[] = {8, 4, 2, 1};
// The least number of moving corners that counts as motion.
constexpr std::ptrdiff_t kLeastMoving = 8;
// Share of the surface; if more of it moves, it is unknown which part is the room.
constexpr double kDividedShare = 0.4;
constexpr std::size_t kTelling = 4;
constexpr std::size_t kPast = 9, kLeastOfBaseline = 24;
// A moving corner rests again after this many frames in which it rested relative to the room.
constexpr std::uint32_t kRestFrames = 30;
// A new corner in a moving region is taken to move until it has rested for this many frames.
constexpr std::uint32_t kBirthFrames = 5;
// At most one corner is followed per cell of this size, the one in which corners are detected
// (core/frame/image_features.cpp).
constexpr int kCell_px = 16;

Eigen::Vector2d image_px(double x, double y, int step) {
  return {(x + 0.5) * step - 0.5, (y + 0.5) * step - 0.5};
}

}  // namespace

struct CornerTracks::Baseline {
  std::vector<FollowedCorner> corners;
  std::vector<std::size_t> tracks;
  std::vector<std::uint8_t> moved_before;
};

CornerTracks::Baseline CornerTracks::since(std::size_t frames) const {
  Baseline baseline;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!places_[i] || tracks_[i].past.size() < frames) continue;
    const Place& then = tracks_[i].past[frames - 1];
    if (then.depth_m <= 0) continue;
    const Eigen::Vector2d from = image_px(double{then.x}, double{then.y}, image_px_);
    baseline.corners.push_back({double{then.depth_m} * camera_.unproject(from.x(), from.y(), 1),
                                image_px(places_[i]->x(), places_[i]->y(), image_px_)});
    baseline.tracks.push_back(i);
    baseline.moved_before.push_back(moves_[i]);
  }
  return baseline;
}

CornerVerdict CornerTracks::follow(const frame::ImageFeatures& last,
                                   const frame::ImageFeatures& frame) {
  CornerVerdict verdict;
  verdict.count = tracks_.size();
  places_.assign(tracks_.size(), std::nullopt);
  moves_.assign(tracks_.size(), 0);
  rests_.assign(tracks_.size(), 0);
  if (last.levels.empty() || frame.levels.empty()) return verdict;
  in_parallel_of_frame(tracks_.size(), [&](std::size_t i) {
    places_[i] =
        track::follow(last, frame, {double{tracks_[i].past[0].x}, double{tracks_[i].past[0].y}});
    moves_[i] = tracks_[i].moves ? 1 : 0;
  });
  label(verdict);
  collect(verdict);
  return verdict;
}

// The verdict of the longest baseline with enough corners holds; shorter ones only add corners that
// move fast enough to be seen.
void CornerTracks::label(CornerVerdict& verdict) {
  std::vector<std::uint8_t> told(tracks_.size(), 0);
  bool is_first = true;
  for (const std::size_t frames : kBaselines) {
    const Baseline baseline = since(frames);
    if (baseline.corners.size() < kLeastOfBaseline) continue;
    const double precision_px =
        kPrecision_px * image_px_ * (1 + kDriftPerFrame * static_cast<double>(frames - 1));
    const auto split =
        split_corners(baseline.corners, baseline.moved_before, camera_, precision_px);
    if (is_first) verdict.is_divided = !split || split->moving_share > kDividedShare;
    if (!split) continue;
    if (is_first) verdict.moving_share = split->moving_share;
    is_first = false;
    const bool moves_now =
        std::count(split->moves.begin(), split->moves.end(), std::uint8_t{1}) >= kLeastMoving;
    verdict.moves_now = verdict.moves_now || moves_now;
    if (keeps_moving_ && !moves_now) continue;
    for (std::size_t k = 0; k < baseline.tracks.size(); ++k) {
      const std::size_t i = baseline.tracks[k];
      const bool moves = split->moves[k] != 0,
                 is_suspect = tracks_[i].moves && tracks_[i].rested_frames < kRestFrames;
      if (told[i] != 0 || !(moves || frames >= kTelling || !is_suspect)) continue;
      moves_[i] = moves || is_suspect ? 1 : 0;
      rests_[i] = moves ? 0 : 1;
      told[i] = 1;
    }
  }
}

void CornerTracks::collect(CornerVerdict& verdict) const {
  const Baseline baseline = since(1);
  for (std::size_t k = 0; k < baseline.tracks.size(); ++k) {
    const bool moves = moves_[baseline.tracks[k]] != 0;
    (moves ? verdict.moving : verdict.resting).push_back(baseline.corners[k]);
    verdict.corners.push_back({baseline.corners[k].pixel, moves});
  }
  if (!keeps_moving_) return;
  if (const auto split = split_corners(verdict.resting, {}, camera_, kPrecision_px * image_px_))
    verdict.last_from_frame = split->earlier_from_frame;
}

void CornerTracks::remember(const frame::ImageFeatures& frame,
                            const std::function<float(int, int)>& depth_m,
                            const std::function<bool(int, int)>& is_moving) {
  image_px_ = frame.image_px;
  const int columns = frame.levels.empty() ? 1 : frame.levels[0].width / kCell_px + 1;
  std::set<int> taken;
  const auto take = [&](double x, double y) {
    return taken.insert(static_cast<int>(y) / kCell_px * columns + static_cast<int>(x) / kCell_px)
        .second;
  };
  const auto nearest = [&](double at) {
    return static_cast<int>(std::lround((at + 0.5) * image_px_ - 0.5));
  };
  std::vector<Track> tracks;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (!places_[i] || !take(places_[i]->x(), places_[i]->y())) continue;
    Track track = std::move(tracks_[i]);
    track.rested_frames = rests_[i] != 0 ? track.rested_frames + 1 : 0;
    track.moves = moves_[i] != 0;
    track.past.insert(track.past.begin(),
                      {static_cast<float>(places_[i]->x()), static_cast<float>(places_[i]->y()),
                       depth_m(nearest(places_[i]->x()), nearest(places_[i]->y()))});
    if (track.past.size() > kPast) track.past.pop_back();
    tracks.push_back(std::move(track));
  }
  for (const frame::Corner& corner : frame.corners) {
    const double x = double{corner.x}, y = double{corner.y};
    if (take(x, y))
      tracks.push_back({{{corner.x, corner.y, corner.depth_m}},
                        kRestFrames - kBirthFrames,
                        is_moving(nearest(x), nearest(y))});
  }
  tracks_ = std::move(tracks);
  places_.assign(tracks_.size(), std::nullopt);
}

void CornerTracks::save(ByteWriter& bytes) const {
  bytes.number(image_px_);
  bytes.list(tracks_, [](ByteWriter& to, const Track& track) {
    to.numbers(track.past);
    to.number(track.rested_frames);
    to.flag(track.moves);
  });
}

void CornerTracks::restore(ByteReader& bytes) {
  bytes.number(image_px_);
  bytes.list(tracks_, [](ByteReader& from, Track& track) {
    from.numbers(track.past);
    from.number(track.rested_frames);
    from.flag(track.moves);
    from.require(!track.past.empty() && track.past.size() <= kPast, "the past of a corner");
  });
  bytes.require(image_px_ == 1 || image_px_ == 2, "the size of a corner's pixels");
  if (!bytes.ok()) tracks_.clear();
  places_.assign(tracks_.size(), std::nullopt);
}

}  // namespace hermite::track
