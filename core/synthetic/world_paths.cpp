#include "core/synthetic/world_paths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/check.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

// Position and direction of the camera: yaw 0 is +x, 90 is +y, continued over the lap so that
// differences are rotations; negative pitch is downwards.
struct WayPoint {
  double x_m, y_m, yaw_deg, pitch_deg;
};
using Control = Eigen::Array4d;  // x, y, yaw, pitch

// Speeds between control points; the spline is never faster.
constexpr double kWalk_m_s = 0.40, kTurn_deg_s = 30, kNod_deg_s = 12;
constexpr double kKnot_s = 0.5;
constexpr double kHeight_m = 1.36;  // as in the furnished room
constexpr double kDegree_rad = M_PI / 180;

// There is a control point on the polygon of way points every kKnot_s, and the curve is their
// uniform quintic B-spline: four derivatives are continuous, it stays within the polygon's hull,
// and since it is a mean of the control points its velocities do not exceed theirs.
class Path {
 public:
  explicit Path(const std::vector<WayPoint>& way) {
    const auto at = [](const WayPoint& point) {
      return Control(point.x_m, point.y_m, point.yaw_deg, point.pitch_deg);
    };
    const auto& [x, y, yaw, pitch] = way.front();
    const double turned_deg = 360 * std::round((way.back().yaw_deg - yaw) / 360);
    std::vector<Control> corners;
    for (const WayPoint& point : way) corners.push_back(at(point));
    corners.push_back(at({x, y, yaw + turned_deg, pitch}));
    per_lap_ = {0, 0, turned_deg, 0};
    std::vector<double> times_s{0};
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const Control step = corners[i] - corners[i - 1];
      times_s.push_back(times_s.back() + std::max({std::hypot(step[0], step[1]) / kWalk_m_s,
                                                   std::abs(step[2]) / kTurn_deg_s,
                                                   std::abs(step[3]) / kNod_deg_s}));
    }
    const auto count = static_cast<std::size_t>(std::ceil(times_s.back() / kKnot_s));
    std::size_t leg = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double time_s = times_s.back() * static_cast<double>(i) / static_cast<double>(count);
      while (times_s[leg + 1] < time_s) ++leg;
      const double share = (time_s - times_s[leg]) / (times_s[leg + 1] - times_s[leg]);
      controls_.push_back(corners[leg] + share * (corners[leg + 1] - corners[leg]));
    }
  }

  double lap_s() const { return kKnot_s * static_cast<double>(controls_.size()); }

  Control at(double laps) const {
    const double whole = std::floor(laps),
                 knots = (laps - whole) * static_cast<double>(controls_.size());
    const auto first = static_cast<std::int64_t>(knots);
    const std::array<double, 6> weights = quintic(knots - static_cast<double>(first));
    Control sum = whole * per_lap_;
    for (int i = 0; i < 6; ++i)
      sum += weights[static_cast<std::size_t>(i)] * control(first + i - 2);
    return sum;
  }

 private:
  Control control(std::int64_t index) const {
    const auto count = static_cast<std::int64_t>(controls_.size());
    const std::int64_t lap = index < 0 ? -1 : index / count;
    return controls_[static_cast<std::size_t>(index - lap * count)] +
           static_cast<double>(lap) * per_lap_;
  }

  // Returns the weights of six control points for t from 0 to 1: the pieces of the quintic B-spline
  // as truncated powers.
  static std::array<double, 6> quintic(double t) {
    constexpr double kBinomial[] = {1, -6, 15, -20, 15, -6};
    std::array<double, 6> weights{};
    for (int piece = 0; piece < 6; ++piece)
      for (int k = 0; k <= piece; ++k)
        weights[static_cast<std::size_t>(5 - piece)] +=
            kBinomial[k] * std::pow(t + piece - k, 5) / 120;
    return weights;
  }

  std::vector<Control> controls_;
  Control per_lap_ = Control::Zero();
};

// Living room, hall eastwards, bedroom, door, living room.
const std::vector<WayPoint> kLoopWay{
    {-1.0, 1.20, 125, -16},  {-1.9, 1.15, 114, -14},  {-2.8, 1.10, 122, -18},
    {-3.5, 0.90, 160, -20},  {-3.95, 0.40, 205, -22}, {-4.0, -0.30, 255, -20},
    {-4.0, -1.20, 292, -16}, {-3.9, -1.60, 310, -16}, {-3.4, -1.68, 318, -16},
    {-2.5, -1.66, 322, -18}, {-1.6, -1.68, 318, -14}, {-0.7, -1.66, 322, -18},
    {0.2, -1.68, 314, -20},  {1.1, -1.66, 320, -16},  {2.0, -1.68, 316, -14},
    {2.8, -1.66, 322, -16},  {3.5, -1.68, 340, -16},  {3.9, -1.60, 380, -16},
    {4.0, -1.20, 412, -18},  {4.0, -0.60, 424, -20},  {3.9, 0.00, 420, -22},
    {3.6, 0.60, 440, -20},   {3.0, 1.10, 455, -16},   {2.3, 1.20, 474, -14},
    {1.5, 1.20, 510, -20},   {0.7, 1.20, 535, -18},   {-0.2, 1.20, 505, -16}};

// One half: from the middle of the passage through the western room and back. The other half is its
// copy, rotated by 180 degrees.
const std::vector<WayPoint> kTwinHalf{
    {0.0, 0.0, 205, -16},    {-0.8, 0.0, 208, -16},   {-1.5, 0.0, 200, -18},
    {-2.1, 0.0, 205, -18},   {-2.8, -0.05, 222, -18}, {-3.6, -0.15, 235, -20},
    {-4.4, -0.15, 238, -18}, {-5.1, 0.1, 205, -20},   {-5.3, 0.6, 165, -20},
    {-4.9, 1.1, 120, -18},   {-4.2, 1.2, 95, -16},    {-3.5, 1.0, 70, -18},
    {-3.0, 0.5, 38, -18},    {-2.7, 0.1, 18, -18},    {-2.1, 0.0, 15, -18},
    {-1.5, 0.0, 20, -16},    {-0.8, 0.0, 28, -16}};

// Along the south side looking at the workplaces, back along the north side looking at the racks.
const std::vector<WayPoint> kOfficeWay{
    {-3.6, -1.58, 55, -20},  {-2.4, -1.60, 62, -22}, {-1.2, -1.60, 52, -18},
    {0.0, -1.60, 62, -22},   {1.2, -1.60, 52, -18},  {2.4, -1.60, 60, -22},
    {3.5, -1.58, 40, -18},   {4.3, -1.20, 30, -16},  {4.5, -0.40, 50, -18},
    {4.5, 0.40, 80, -18},    {4.3, 1.20, 118, -18},  {3.5, 1.58, 130, -20},
    {2.4, 1.58, 120, -16},   {1.2, 1.58, 132, -20},  {0.0, 1.58, 122, -16},
    {-1.2, 1.58, 132, -20},  {-2.4, 1.58, 122, -16}, {-3.5, 1.58, 150, -18},
    {-4.3, 1.20, 195, -18},  {-4.5, 0.40, 230, -18}, {-4.5, -0.40, 290, -18},
    {-4.3, -1.20, 350, -18}, {-3.9, -1.50, 395, -18}};

// Counter-clockwise around the block, looking ahead and a little outwards.
const std::vector<WayPoint> kBlankWay{
    {-1.8, -1.85, -28, -18}, {-0.6, -1.85, -22, -20}, {0.6, -1.85, -28, -18},
    {1.8, -1.85, -20, -20},  {2.6, -1.7, 10, -26},    {2.85, -0.9, 60, -26},
    {2.85, 0.0, 66, -20},    {2.85, 0.9, 72, -18},    {2.6, 1.7, 110, -20},
    {1.8, 1.85, 150, -18},   {0.6, 1.85, 156, -20},   {-0.6, 1.85, 150, -18},
    {-1.8, 1.85, 158, -20},  {-2.6, 1.7, 190, -26},   {-2.85, 0.9, 240, -26},
    {-2.85, 0.0, 246, -20},  {-2.85, -0.9, 252, -18}, {-2.6, -1.7, 290, -20}};

std::vector<WayPoint> twins_way() {
  std::vector<WayPoint> way = kTwinHalf;
  for (const auto& [x, y, yaw, pitch] : kTwinHalf) way.push_back({-x, -y, yaw - 180, pitch});
  return way;
}

const Path& path_of(RoomScene scene) {
  static const Path kLoop(kLoopWay), kTwins(twins_way()), kOffice(kOfficeWay), kBlank(kBlankWay);
  switch (scene) {
    case RoomScene::kLoop: return kLoop;
    case RoomScene::kTwins: return kTwins;
    case RoomScene::kOffice: return kOffice;
    case RoomScene::kBlank: return kBlank;
    case RoomScene::kRoom:
    case RoomScene::kBare:
    case RoomScene::kTurntable:
    case RoomScene::kPoster: break;
  }
  CHECK(false, "this scene's way is no path of way points");
  return kLoop;
}

}  // namespace

Rigid3 camera_at(const Vector3d& position_m, double heading_rad, double pitch_rad,
                 double roll_rad) {
  const Vector3d forward(std::cos(pitch_rad) * std::cos(heading_rad),
                         std::cos(pitch_rad) * std::sin(heading_rad), std::sin(pitch_rad));
  const Vector3d right(std::sin(heading_rad), -std::cos(heading_rad), 0);
  Eigen::Matrix3d world_from_camera;
  world_from_camera.col(0) = right;
  world_from_camera.col(1) = forward.cross(right);
  world_from_camera.col(2) = forward;
  const Eigen::Quaterniond rolled(
      world_from_camera * Eigen::AngleAxisd(roll_rad, Vector3d::UnitZ()).toRotationMatrix());
  return {rolled.normalized(), position_m};
}

double world_lap_s(RoomScene scene) { return path_of(scene).lap_s(); }

Rigid3 world_pose(RoomScene scene, double laps) {
  const Control here = path_of(scene).at(laps);
  // Changes sign between laps: the first is from higher up and looks further down.
  const double alternating = std::sin(M_PI * laps);
  const double sway = 2 * M_PI * laps;
  const Vector3d position(here[0], here[1],
                          kHeight_m + 0.04 * std::sin(4 * sway + 0.7) + 0.10 * alternating);
  const double heading = kDegree_rad * here[2], pitch = kDegree_rad * (here[3] - 4 * alternating);
  const double roll = kDegree_rad * 2 * std::sin(6 * sway + 0.3);
  return camera_at(position, heading, pitch, roll);
}

}  // namespace hermite::synthetic
