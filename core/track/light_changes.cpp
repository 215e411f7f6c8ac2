#include "core/track/light_changes.h"

#include <algorithm>
#include <cmath>

#include "core/base/frame_helpers.h"
#include "core/math/rigid3_fields.h"
#include "core/track/coarse_masks.h"

namespace hermite::track {

namespace {

// Every eighth frame is kept, eight in all: two seconds at 30 Hz, in which light that moves by 5
// cm/s passes three coarse pixels 2 m away.
constexpr std::uint32_t kLightEvery = 8;
constexpr std::size_t kLightKept = 8;

// A pixel has changed if at least this share of the views say so: a slow edge is noticed by the
// older ones alone.
constexpr double kLeastAgainst = 0.25;

// Grey values, and share of them, by which a coarse pixel may differ: noise of mean grey values,
// shading of the lens that is not learned yet, and surfaces that do not look the same from
// everywhere.
constexpr double kTolerated_grey = 8, kToleratedShare = 0.06;

// Nothing is known of pixels that are brighter than this, or of the exposure from darker ones.
constexpr float kSaturated_grey = 250, kDark_grey = 10;

// Share of the pixels; smaller regions are edges and highlights of small things. And share of the
// surface, above which it is the image as a whole that changes.
constexpr double kLeastPatch = 0.001, kMostChanged = 0.35;

// In a view full of edges, others hold the camera: with a spot of sun a furnished room is 2.6 mm
// off, with and without this class. There highlights, blur and the edges of depth would be taken
// for light that moves, and edges that are left out are missed: of a recorded kitchen 38 % of the
// frames were weak instead of 24. Shares of the surface, mean and range: bare walls 6 % (5 to 10),
// rooms and recordings 14 to 27 %.
constexpr double kFewEdges = 0.12;

// The edge of a region, which pulls, is in the coarse pixels beside it.
constexpr int kAround_px = 2;

// What a view shows around a point: grey values within a pixel of it.
struct Shown {
  float low = 0, high = -1, middle = 0;  // high < low: nothing, or another surface
  bool is_known() const { return high >= low; }
};

Shown shown_at(const frame::CoarseView& view, const frame::CoarseMask& moving,
               const Eigen::Vector3d& point) {
  Shown shown;
  if (point.z() < 0.05) return shown;
  const Eigen::Vector2d uv = view.project(point);
  const int x = static_cast<int>(std::lround(uv.x())), y = static_cast<int>(std::lround(uv.y()));
  if (!view.contains(x - 1, y - 1) || !view.contains(x + 1, y + 1)) return shown;
  float low = 255, high = 0;
  for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
    const std::size_t i = view.index(x + dx, y + dy);
    const double behind_m = view.normals[i].cast<double>().dot(point - view.point(x + dx, y + dy));
    if (view.depth_m[i] <= 0 || moving[i] != 0 || std::abs(behind_m) > clearly_m(point.z()))
      return shown;
    low = std::min(low, view.grey[i]);
    high = std::max(high, view.grey[i]);
  }
  return {low, high, view.grey[view.index(x, y)]};
}

// Returns by how much brighter the frame is than the view, by row, since mains light makes bands:
// medians over what both show in that row and those beside it. 0: too little is seen in both.
std::vector<double> gains_of(const frame::CoarseView& frame, const std::vector<Shown>& shown) {
  constexpr int kBeside = 2;
  constexpr std::size_t kLeastPixels = 50;
  const int width = static_cast<int>(frame.camera.width),
            height = static_cast<int>(frame.camera.height);
  std::vector<double> by_row(static_cast<std::size_t>(height), 0);
  std::vector<float> gains;
  for (int row = 0; row < height; ++row) {
    gains.clear();
    for (int y = std::max(0, row - kBeside); y <= std::min(height - 1, row + kBeside); ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = frame.index(x, y);
        const bool is_usable = shown[i].is_known() &&
                               std::min(frame.grey[i], shown[i].middle) > kDark_grey &&
                               std::max(frame.grey[i], shown[i].middle) < kSaturated_grey;
        if (is_usable) gains.push_back(frame.grey[i] / shown[i].middle);
      }
    if (gains.size() < kLeastPixels) continue;
    const auto middle = gains.begin() + static_cast<std::ptrdiff_t>(gains.size() / 2);
    std::nth_element(gains.begin(), middle, gains.end());
    by_row[static_cast<std::size_t>(row)] = static_cast<double>(*middle);
  }
  return by_row;
}

// Returns the pixels across which the grey value changes by more than light may. An edge that moves
// in a part of its length moves as a whole, though only where it moves across itself can it be
// seen.
frame::CoarseMask edges_of(const frame::CoarseView& view) {
  frame::CoarseMask edges(view.size(), 0);
  for (int y = 1; y + 1 < static_cast<int>(view.camera.height); ++y)
    for (int x = 1; x + 1 < static_cast<int>(view.camera.width); ++x) {
      const std::size_t i = view.index(x, y);
      const float across = std::abs(view.grey[i + 1] - view.grey[i - 1]);
      const float along =
          std::abs(view.grey[i + view.camera.width] - view.grey[i - view.camera.width]);
      const bool is_edge =
          static_cast<double>(std::max(across, along)) >
          2 * (kTolerated_grey + kToleratedShare * static_cast<double>(view.grey[i]));
      edges[i] = view.depth_m[i] > 0 && is_edge ? 1 : 0;
    }
  return edges;
}

}  // namespace

// Returns what a view says about the brightness of each pixel of the frame.
std::vector<LightChanges::Light> LightChanges::light_since(const Seen& seen,
                                                           const frame::CoarseView& frame,
                                                           const Rigid3& world_from_camera,
                                                           const frame::CoarseMask& moving) {
  const Rigid3 view_from_frame = inverse(seen.world_from_camera) * world_from_camera;
  std::vector<Shown> shown(frame.size());
  for (int y = 0; y < static_cast<int>(frame.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(frame.camera.width); ++x) {
      const std::size_t i = frame.index(x, y);
      if (frame.depth_m[i] > 0 && moving[i] == 0)
        shown[i] = shown_at(seen.view, seen.moving, view_from_frame * frame.point(x, y));
    }
  const std::vector<double> gains = gains_of(frame, shown);
  std::vector<Light> light(frame.size(), Light::kUnknown);
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double gain = gains[i / frame.camera.width];
    if (!shown[i].is_known() || gain == 0) continue;
    const double low = gain * static_cast<double>(shown[i].low),
                 high = gain * static_cast<double>(shown[i].high);
    const double grey = static_cast<double>(frame.grey[i]),
                 tolerance = kTolerated_grey + kToleratedShare * grey;
    light[i] = grey < low - tolerance || grey > high + tolerance ? Light::kChanged : Light::kSame;
  }
  return light;
}

frame::CoarseMask LightChanges::expected(const frame::CoarseView& view) const {
  if (last_changed_.size() != view.size()) return frame::CoarseMask(view.size(), 0);
  return beside(last_changed_, last_view_, view);
}

frame::CoarseMask LightChanges::changed(const frame::CoarseView& view,
                                        const Rigid3& world_from_camera,
                                        const frame::CoarseMask& moving) const {
  const frame::CoarseMask edges = edges_of(view);
  if (share_of_surface(edges, view) > kFewEdges) return frame::CoarseMask(view.size(), 0);
  std::vector<std::vector<Light>> by_view(seen_.size());
  in_parallel_of_frame(seen_.size(), [&](std::size_t i) {
    by_view[i] = light_since(seen_[i], view, world_from_camera, moving);
  });
  frame::CoarseMask changed(view.size(), 0);
  for (std::size_t i = 0; i < view.size(); ++i) {
    int against = 0, known = 0;
    for (const std::vector<Light>& light : by_view) {
      against += light[i] == Light::kChanged ? 1 : 0;
      known += light[i] != Light::kUnknown ? 1 : 0;
    }
    changed[i] = against > 0 && against >= kLeastAgainst * known ? 1 : 0;
  }
  const auto least =
      static_cast<std::size_t>(std::ceil(kLeastPatch * static_cast<double>(view.size())));
  changed = regions(changed, edges, view, least);
  if (share_of_surface(changed, view) > kMostChanged) changed.assign(view.size(), 0);
  return grown(changed, view, kAround_px);
}

void LightChanges::remember(const frame::CoarseView& view, const Rigid3& world_from_camera,
                            const frame::CoarseMask& moving, const frame::CoarseMask& changed) {
  last_view_ = view;
  last_changed_ = changed;
  if (frames_since_kept_ == 0) seen_.push_back({view, world_from_camera, moving});
  if (seen_.size() > kLightKept) seen_.pop_front();
  frames_since_kept_ = (frames_since_kept_ + 1) % kLightEvery;
}

void LightChanges::forget() {
  seen_.clear();
  last_view_ = {};
  last_changed_.clear();
  frames_since_kept_ = 0;
}

void LightChanges::save(ByteWriter& bytes) const {
  bytes.list(std::vector<Seen>(seen_.begin(), seen_.end()), [](ByteWriter& to, const Seen& seen) {
    frame::save(to, seen.view);
    rigid3_fields(to, seen.world_from_camera);
    to.numbers(seen.moving);
  });
  frame::save(bytes, last_view_);
  bytes.numbers(last_changed_);
  bytes.number(frames_since_kept_);
}

void LightChanges::restore(ByteReader& bytes) {
  std::vector<Seen> seen;
  bytes.list(seen, [](ByteReader& from, Seen& view) {
    frame::restore(from, view.view);
    rigid3_fields(from, view.world_from_camera);
    from.numbers(view.moving);
    from.require(view.moving.size() == view.view.size(), "what moved in a coarse view");
  });
  seen_.assign(seen.begin(), seen.end());
  frame::restore(bytes, last_view_);
  bytes.numbers(last_changed_);
  bytes.number(frames_since_kept_);
  bytes.require(seen_.size() <= kLightKept && frames_since_kept_ < kLightEvery &&
                    last_changed_.size() == last_view_.size(),
                "the views that changes of light are told by");
}

}  // namespace hermite::track
