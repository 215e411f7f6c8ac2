#include "core/track/moving_regions.h"

#include <algorithm>
#include <cmath>

#include "core/base/frame_helpers.h"
#include "core/math/rigid3_fields.h"
#include "core/track/coarse_masks.h"
#include "core/track/twist_covariance.h"

namespace hermite::track {

namespace {

// Every fourth frame is kept, eight in all: a second at 30 Hz. A walking person moves by their own
// width in half of it.
constexpr std::uint32_t kKeepEvery = 4;
constexpr std::size_t kKept = 8;

// The usual disagreement of surfaces is a mean over about this many frames.
constexpr double kUsualOver = 30;

// Share of the pixels; smaller regions are edges and reflections. And share of the surface; if more
// contradicts, the pose is wrong.
constexpr double kLeastRegion = 0.005, kMostMoving = 0.6;

// What a view says about a point of another one.
enum class Witness { kNothing, kSame, kFree, kHidden };

// A view with its points, as every comparison needs them.
struct ViewWithPoints {
  const frame::CoarseView& view;
  const std::vector<Eigen::Vector3d>& points;
};

// A pixel of the view whose neighbours it contains, too.
struct ViewPixel {
  bool is_inside = false;
  int x = 0, y = 0;
};

// `point` is in the camera frame of `view`.
ViewPixel pixel_of(const frame::CoarseView& view, const Eigen::Vector3d& point) {
  if (point.z() < 0.05) return {};
  const Eigen::Vector2d uv = view.project(point);
  if (!(uv.minCoeff() >= 0.5 && uv.x() < view.camera.width - 1.5 &&
        uv.y() < view.camera.height - 1.5))
    return {};
  return {true, static_cast<int>(uv.x() + 0.5), static_cast<int>(uv.y() + 0.5)};
}

// Returns what the view shows around the place of the point. kFree: it sees through the point at
// every pixel around it. kHidden: the point lies behind the surface that the view shows.
Witness ask(const ViewWithPoints& shown, const ViewPixel& place, const Eigen::Vector3d& point) {
  const frame::CoarseView& view = shown.view;
  if (!place.is_inside) return Witness::kNothing;
  const double tolerance_m = clearly_m(point.z());
  int known = 0, free = 0, hidden = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const std::size_t i = view.index(place.x + dx, place.y + dy);
      if (view.depth_m[i] <= 0) continue;
      ++known;
      const Eigen::Vector3d normal = view.normals[i].cast<double>();
      const double behind_m = normal.dot(point - shown.points[i]);
      if (std::abs(behind_m) <= tolerance_m) return Witness::kSame;
      const double deeper_m = point.z() - view.depth_m[i];
      free += behind_m < 0 && deeper_m < -tolerance_m ? 1 : 0;
      hidden += behind_m > 0 && deeper_m > tolerance_m ? 1 : 0;
    }
  if (known < 5) return Witness::kNothing;
  if (free == known) return Witness::kFree;
  return hidden == known ? Witness::kHidden : Witness::kNothing;
}

// By pixel: the number of views that contradict it, and of those that show the same surface.
struct Votes {
  std::vector<int> against, for_;
  explicit Votes(std::size_t pixels) : against(pixels, 0), for_(pixels, 0) {}
  void add(const Votes& other) {
    for (std::size_t i = 0; i < against.size(); ++i)
      against[i] += other.against[i], for_[i] += other.for_[i];
  }
};

// Votes against points of the frame in free space of the view.
void appeared(const ViewWithPoints& frame, const ViewWithPoints& earlier,
              const Rigid3& view_from_frame, Votes& votes) {
  const Eigen::Matrix3d rotation = view_from_frame.rotation.toRotationMatrix();
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.view.depth_m[i] <= 0) continue;
    const Eigen::Vector3d point = rotation * frame.points[i] + view_from_frame.translation;
    const Witness witness = ask(earlier, pixel_of(earlier.view, point), point);
    votes.against[i] += witness == Witness::kFree ? 1 : 0;
    votes.for_[i] += witness == Witness::kSame ? 1 : 0;
  }
}

// Votes for points of the view that the frame sees through: what was there has moved away, or the
// surface behind it was hidden. Points that moved in the view are ignored.
void vanished(const ViewWithPoints& frame, const ViewWithPoints& earlier,
              const frame::CoarseMask& moved, const Rigid3& frame_from_view, Votes& votes) {
  const Eigen::Matrix3d rotation = frame_from_view.rotation.toRotationMatrix();
  for (std::size_t i = 0; i < earlier.points.size(); ++i) {
    if (earlier.view.depth_m[i] <= 0 || moved[i] != 0) continue;
    const Eigen::Vector3d point = rotation * earlier.points[i] + frame_from_view.translation;
    const ViewPixel place = pixel_of(frame.view, point);
    if (ask(frame, place, point) == Witness::kFree)
      ++votes.against[frame.view.index(place.x, place.y)];
  }
}

// Lets a view, in which `moved` moved, vote on the pixels of the frame.
void vote(const ViewWithPoints& frame, const ViewWithPoints& earlier,
          const frame::CoarseMask& moved, const Rigid3& view_from_frame, Votes& votes) {
  appeared(frame, earlier, view_from_frame, votes);
  vanished(frame, earlier, moved, inverse(view_from_frame), votes);
}

// Returns the regions that more views contradict than show.
frame::CoarseMask contradicted_by(const std::vector<Votes>& votes_by_view,
                                  const frame::CoarseView& view) {
  Votes votes(view.size());
  for (const Votes& of_view : votes_by_view) votes.add(of_view);
  frame::CoarseMask seeds(view.size(), 0), candidates(view.size(), 0);
  for (std::size_t i = 0; i < view.size(); ++i) {
    seeds[i] = view.depth_m[i] > 0 && votes.against[i] > 0 && 2 * votes.against[i] >= votes.for_[i]
                   ? 1
                   : 0;
    candidates[i] = view.depth_m[i] > 0 && votes.against[i] >= votes.for_[i] ? 1 : 0;
  }
  const auto least =
      static_cast<std::size_t>(std::ceil(kLeastRegion * static_cast<double>(view.size())));
  frame::CoarseMask moving = regions(seeds, candidates, view, least);
  if (share_of_surface(moving, view) > kMostMoving) moving.assign(view.size(), 0);
  return moving;
}

// Returns the twist that moves a camera at this position farther.
Vector6d greater(const Vector6d& a, const Vector6d& b, const Eigen::Vector3d& position_world) {
  const auto distance_m = [moved = at_camera(position_world)](const Vector6d& twist) {
    return (moved * twist).head<3>().norm();
  };
  return distance_m(b) > distance_m(a) ? b : a;
}

}  // namespace

frame::CoarseMask MovingRegions::expected(const frame::CoarseView& view) const {
  if (last_moving_.size() != view.size()) return frame::CoarseMask(view.size(), 0);
  return beside(last_moving_, last_view_, view);
}

frame::CoarseMask MovingRegions::contradicted(const frame::CoarseView& view,
                                              const ViewSurfaces& surfaces,
                                              const Rigid3& world_from_camera,
                                              const frame::CoarseMask& by_corners) {
  is_divided_ = false;
  pull_world_.setZero();
  frame::CoarseMask moving(view.size(), 0);
  if (!seen_.empty()) {
    const std::vector<Eigen::Vector3d> points = frame::points_of(view);
    const std::vector<bool> moved_before = moving_before(view, surfaces, by_corners);
    const auto since = [&](const Seen& seen, const Disagreement& disagreement,
                           const std::vector<bool>& moves) {
      const CameraMotion motion{inverse(seen.world_from_camera) * world_from_camera,
                                seen.step_before,
                                log_se3(inverse(last_world_from_camera_) * world_from_camera)};
      return own_motions(view, surfaces, seen.view, motion, {moves, disagreement.usual});
    };
    OwnMotions lately, all_along;
    std::vector<Votes> votes_by_view(seen_.size(), Votes(view.size()));
    // The longest pieces first.
    in_parallel_of_frame(2 + seen_.size(), [&](std::size_t i) {
      if (i == 0) lately = since(recent(), lately_, moved_before);
      if (i == 1) all_along = since(seen_.front(), all_along_, moved_before);
      if (i < 2) return;
      const Seen& seen = seen_[i - 2];
      vote({view, points}, {seen.view, seen.points}, seen.moving,
           inverse(seen.world_from_camera) * world_from_camera, votes_by_view[i - 2]);
    });
    // Surfaces found to move recently must not influence the camera's motion in the longer
    // comparison either.
    std::vector<bool> moves = moved_before;
    for (std::size_t surface = 1; surface < moves.size(); ++surface)
      moves[surface] = moves[surface] || lately.of_surface[surface] == OwnMotion::kMoves;
    if (moves != moved_before) all_along = since(seen_.front(), all_along_, moves);
    moving = contradicted_by(votes_by_view, view);
    add_own_motions(surfaces, moves, lately, all_along, moving);
    pull_world_ = greater(adjoint(recent().world_from_camera) * lately.pull,
                          adjoint(seen_.front().world_from_camera) * all_along.pull,
                          world_from_camera.translation);
  }
  for (std::size_t i = 0; i < by_corners.size(); ++i) moving[i] |= by_corners[i];
  return grown(moving, view, 1);
}

// Returns which surfaces of the frame are mostly covered by what moved in the last frame or is told
// to move by corners.
std::vector<bool> MovingRegions::moving_before(const frame::CoarseView& view,
                                               const ViewSurfaces& surfaces,
                                               const frame::CoarseMask& by_corners) const {
  frame::CoarseMask carried = expected(view);
  for (std::size_t i = 0; i < by_corners.size(); ++i) carried[i] |= by_corners[i];
  std::vector<std::size_t> carried_pixels(surfaces.pixel_count.size());
  for (std::size_t i = 0; i < view.size(); ++i) carried_pixels[surfaces.of_pixel[i]] += carried[i];
  std::vector<bool> moves(surfaces.pixel_count.size(), false);
  for (std::size_t surface = 1; surface < moves.size(); ++surface)
    moves[surface] = 2 * carried_pixels[surface] > surfaces.pixel_count[surface];
  return moves;
}

// Returns the view some frames ago, which shows fast motion; the oldest one shows slow motion and
// what has come to rest.
const MovingRegions::Seen& MovingRegions::recent() const {
  const bool newest_is_young = frames_since_kept_ != 0 && frames_since_kept_ + 1 < kKeepEvery;
  return newest_is_young && seen_.size() > 1 ? seen_[seen_.size() - 2] : seen_.back();
}

// Adds the pixels of surfaces that move on their own in either comparison. A surface that neither
// knows stays what it was.
void MovingRegions::add_own_motions(const ViewSurfaces& surfaces,
                                    const std::vector<bool>& moved_before, const OwnMotions& lately,
                                    const OwnMotions& all_along, frame::CoarseMask& moving) {
  lately_.last = lately.disagreement;
  all_along_.last = all_along.disagreement;
  is_divided_ = lately.is_divided || all_along.is_divided;
  std::vector<bool> moves(moved_before.size(), false);
  for (std::size_t surface = 1; surface < moves.size(); ++surface) {
    const OwnMotion a = lately.of_surface[surface], b = all_along.of_surface[surface];
    const bool is_unknown = a == OwnMotion::kUnknown && b == OwnMotion::kUnknown;
    moves[surface] =
        a == OwnMotion::kMoves || b == OwnMotion::kMoves || (is_unknown && moved_before[surface]);
  }
  for (std::size_t i = 0; i < moving.size(); ++i) moving[i] |= moves[surfaces.of_pixel[i]] ? 1 : 0;
}

void MovingRegions::remember(const frame::CoarseView& view, const Rigid3& world_from_camera,
                             const frame::CoarseMask& moving) {
  const Vector6d step = last_view_.empty()
                            ? Vector6d::Zero()
                            : log_se3(inverse(last_world_from_camera_) * world_from_camera);
  last_view_ = view;
  last_world_from_camera_ = world_from_camera;
  last_moving_ = moving;
  pull_world_.setZero();
  // What is first seen to move now was already moving in the frame before, in which it could not be
  // detected yet.
  if (frames_since_kept_ == 1 && seen_.back().view.size() == view.size()) {
    const frame::CoarseMask moved = beside(moving, view, seen_.back().view);
    for (std::size_t i = 0; i < moved.size(); ++i) seen_.back().moving[i] |= moved[i];
  }
  if (frames_since_kept_ == 0)
    seen_.push_back({view, frame::points_of(view), world_from_camera, step, moving});
  if (seen_.size() > kKept) seen_.pop_front();
  for (Disagreement* disagreement : {&lately_, &all_along_})
    disagreement->usual = std::max(
        1.0, disagreement->usual + (disagreement->last - disagreement->usual) / kUsualOver);
  frames_since_kept_ = (frames_since_kept_ + 1) % kKeepEvery;
}

void MovingRegions::forget() {
  seen_.clear();
  last_view_ = {};
  last_moving_.clear();
  frames_since_kept_ = 0;
}

void MovingRegions::save(ByteWriter& bytes) const {
  bytes.list(std::vector<Seen>(seen_.begin(), seen_.end()), [](ByteWriter& to, const Seen& seen) {
    frame::save(to, seen.view);
    rigid3_fields(to, seen.world_from_camera);
    for (const double part : seen.step_before) to.number(part);
    to.numbers(seen.moving);
  });
  frame::save(bytes, last_view_);
  rigid3_fields(bytes, last_world_from_camera_);
  bytes.number(lately_);
  bytes.number(all_along_);
  bytes.numbers(last_moving_);
  bytes.number(frames_since_kept_);
}

void MovingRegions::restore(ByteReader& bytes) {
  std::vector<Seen> seen;
  bytes.list(seen, [](ByteReader& from, Seen& view) {
    frame::restore(from, view.view);
    if (from.ok()) view.points = frame::points_of(view.view);
    rigid3_fields(from, view.world_from_camera);
    for (double& part : view.step_before) from.number(part);
    from.numbers(view.moving);
    from.require(view.moving.size() == view.view.size(), "what moved in a coarse view");
  });
  seen_.assign(seen.begin(), seen.end());
  frame::restore(bytes, last_view_);
  rigid3_fields(bytes, last_world_from_camera_);
  bytes.number(lately_);
  bytes.number(all_along_);
  bytes.numbers(last_moving_);
  bytes.number(frames_since_kept_);
  bytes.require(seen_.size() <= kKept && frames_since_kept_ < kKeepEvery &&
                    last_moving_.size() == last_view_.size(),
                "the views that motion is told by");
}

}  // namespace hermite::track
