#include "core/disturb/pane_disturbance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/disturb/depth_units.h"
#include "core/disturb/key_values.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/disturb/seen_surface.h"
#include "core/disturb/true_view.h"
#include "core/math/counted_random.h"

namespace hermite::disturb {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr const char *kMirror = "mirror", *kGlass = "glass", *kScreen = "screen", *kDoor = "door";
constexpr double kNearestPane_m = 0.3;
// The room in front of a mirror begins at this distance; nearer surfaces may be those on which it
// hangs.
constexpr double kInFront_m = 0.02;
constexpr Rgb8 kUnseen{28, 30, 32};
constexpr double kHole_m = 0.04, kSpeck_m = 0.01;

std::vector<KeyValueRule> pane_rules(PaneOptions& pane) {
  return {number_rule("width_m", 0.1, 10, pane.width_m),
          number_rule("height_m", 0.1, 10, pane.height_m),
          number_rule("distance_m", 0.3, 10, pane.distance_m),
          number_rule("turn_deg", -80, 80, pane.turn_deg)};
}

// Intersection of a ray through a pixel with a pane.
struct Met {
  double depth_m = 0;                // 0: none
  Vector2d at_m = Vector2d::Zero();  // from the pane's centre: horizontal and up
};

class PanedSequence : public RedrawnSequence {
 public:
  PanedSequence(std::unique_ptr<dataset::Sequence> original, const char* name, const Pane& pane)
      : RedrawnSequence(std::move(original)), pane_(pane), name_(name), rays_(rays_of(camera())) {}

 protected:
  virtual bool has_back() const = 0;
  // `met` has the intersections of the pixels' rays with the pane where it is in front of the
  // scene.
  virtual void show(const Image<Met>& met, const Rigid3& world_from_camera, DepthImage& depth,
                    ColorImage& color, std::int64_t index) const = 0;

  const Pane pane_;

 private:
  // Where the pane is at that time.
  virtual Pane pane_at(double /*time_s*/) const { return pane_; }

  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const override {
    const Pane pane = pane_at(timestamp_s(index));
    const Result<Rigid3> pose = true_pose(*original_, timestamp_s(index), name_);
    if (!pose.ok()) return pose.error();
    const Matrix3d rotation = pose->rotation.toRotationMatrix();
    Image<Met> met(depth.width, depth.height);
    bool is_met = false;
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x) {
        const Met at = meet(pane, pose->translation, rotation * rays_.at(x, y));
        const double scene_m = depth.at(x, y) / camera().depth_units_per_metre;
        if (at.depth_m < kNearestPane_m || (scene_m > 0 && scene_m <= at.depth_m)) continue;
        met.at(x, y) = at;
        is_met = true;
      }
    if (is_met) show(met, *pose, depth, color, index);
    return Done{};
  }

  Met meet(const Pane& pane, const Vector3d& origin, const Vector3d& direction) const {
    const double towards = direction.dot(pane.normal_world),
                 height_m = (origin - pane.middle_world).dot(pane.normal_world);
    if (towards == 0 || (height_m <= 0 && !has_back())) return {};
    const double depth_m = -height_m / towards;
    const Vector3d from_middle = origin + depth_m * direction - pane.middle_world;
    const Vector2d at_m(from_middle.dot(pane.across_world), from_middle.dot(pane.up_world));
    if (depth_m <= 0 || std::abs(at_m.x()) > pane.half_width_m ||
        std::abs(at_m.y()) > pane.half_height_m)
      return {};
    return {depth_m, at_m};
  }

  const std::string name_;
  const Image<Vector3d> rays_;
};

SeenSurface mirrored(SeenSurface surface, const Pane& pane) {
  std::erase_if(surface.triangles, [&](const auto& corners) {
    return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t i) {
      return (surface.points[i].position_m - pane.middle_world).dot(pane.normal_world) < kInFront_m;
    });
  });
  for (ColoredPoint& point : surface.points) point.position_m = pane.mirrored(point.position_m);
  return surface;
}

class Mirrored : public PanedSequence {
 public:
  Mirrored(std::unique_ptr<dataset::Sequence> original, const Pane& pane)
      : PanedSequence(std::move(original), kMirror, pane),
        reflection_(mirrored(seen_surface(*original_), pane)) {}

 private:
  bool has_back() const override { return false; }

  void show(const Image<Met>& met, const Rigid3& world_from_camera, DepthImage& depth,
            ColorImage& color, std::int64_t /*index*/) const override {
    Image<std::uint8_t> is_mirror(depth.width, depth.height);
    for (std::size_t i = 0; i < met.pixels.size(); ++i)
      is_mirror.pixels[i] = met.pixels[i].depth_m > 0 ? 1 : 0;
    const Rigid3 camera_from_world = inverse(world_from_camera);
    SeenSurface in_camera = reflection_;
    for (ColoredPoint& point : in_camera.points)
      point.position_m = camera_from_world * point.position_m;
    const Image<DrawnPixel> drawn = draw(in_camera, camera(), is_mirror);
    for (std::size_t i = 0; i < met.pixels.size(); ++i) {
      if (!is_mirror.pixels[i]) continue;
      const DrawnPixel& pixel = drawn.pixels[i];
      const auto byte = [&](int channel) {
        return static_cast<std::uint8_t>(std::lround(pixel.color[channel]));
      };
      depth.pixels[i] = to_depth_units(pixel.depth_m, camera().depth_units_per_metre);
      color.pixels[i] = pixel.depth_m > 0 ? Rgb8{byte(0), byte(1), byte(2)} : kUnseen;
    }
  }

  const SeenSurface reflection_;  // in the world
};

class Glazed : public PanedSequence {
 public:
  Glazed(std::unique_ptr<dataset::Sequence> original, const Pane& pane, const PaneOptions& options)
      : PanedSequence(std::move(original), kGlass, pane), options_(options) {}

 private:
  bool has_back() const override { return true; }

  void show(const Image<Met>& met, const Rigid3& /*world_from_camera*/, DepthImage& depth,
            ColorImage& /*color*/, std::int64_t index) const override {
    const std::uint64_t dirt = mix_bits(options_.seed), missing = frame_key(options_.seed, index);
    for (std::size_t i = 0; i < met.pixels.size(); ++i) {
      const auto& [depth_m, at_m] = met.pixels[i];
      if (depth_m == 0) continue;
      if (unit_uniform(dirt, square_at(at_m, kSpeck_m)) < options_.specks)
        depth.pixels[i] = to_depth_units(depth_m, camera().depth_units_per_metre);
      else if (unit_uniform(missing, square_at(at_m, kHole_m)) < options_.holes)
        depth.pixels[i] = 0;
    }
  }

  // Returns a different number for each square of the pane.
  static std::uint64_t square_at(const Vector2d& at_m, double side_m) {
    const auto whole = [side_m](double position_m) {
      return static_cast<std::uint32_t>(std::lround(std::floor(position_m / side_m)));
    };
    return std::uint64_t{whole(at_m.x())} << 32 | whole(at_m.y());
  }

  const PaneOptions options_;
};

// A pane that nothing passes, with a pattern.
class Opaque : public PanedSequence {
 public:
  using PanedSequence::PanedSequence;

 private:
  bool has_back() const override { return true; }
  virtual Rgb8 color_at(const Vector2d& at_m, double time_s) const = 0;

  void show(const Image<Met>& met, const Rigid3& /*world_from_camera*/, DepthImage& depth,
            ColorImage& color, std::int64_t index) const override {
    for (std::size_t i = 0; i < met.pixels.size(); ++i) {
      if (met.pixels[i].depth_m == 0) continue;
      depth.pixels[i] = to_depth_units(met.pixels[i].depth_m, camera().depth_units_per_metre);
      color.pixels[i] = color_at(met.pixels[i].at_m, timestamp_s(index));
    }
  }
};

class Screen : public Opaque {
 public:
  Screen(std::unique_ptr<dataset::Sequence> original, const Pane& pane, double speed_m_s)
      : Opaque(std::move(original), kScreen, pane), speed_m_s_(speed_m_s) {}

 private:
  Rgb8 color_at(const Vector2d& at_m, double time_s) const override {
    constexpr Rgb8 kSky{150, 190, 230}, kHill{70, 110, 50};
    constexpr double kCheck_m = 0.12;
    const double x = at_m.x() - speed_m_s_ * (time_s - timestamp_s(0));
    return std::lround(std::floor(x / kCheck_m) + std::floor(at_m.y() / kCheck_m)) % 2 == 0 ? kSky
                                                                                            : kHill;
  }

  const double speed_m_s_;
};

struct DoorOptions {
  double swing_deg = 60, period_s = 4;
};

class Door : public Opaque {
 public:
  Door(std::unique_ptr<dataset::Sequence> original, const Pane& pane, const DoorOptions& swing)
      : Opaque(std::move(original), kDoor, pane),
        swing_(swing),
        hinge_world_(pane.middle_world - pane.half_width_m * pane.across_world) {}

 private:
  Pane pane_at(double time_s) const override {
    const double phase = 2 * M_PI * (time_s - timestamp_s(0)) / swing_.period_s;
    const Eigen::AngleAxisd turn(0.5 * swing_.swing_deg * (1 - std::cos(phase)) * M_PI / 180,
                                 pane_.up_world);
    Pane pane = pane_;
    pane.middle_world = hinge_world_ + turn * (pane_.middle_world - hinge_world_);
    pane.across_world = turn * pane_.across_world;
    pane.normal_world = turn * pane_.normal_world;
    return pane;
  }

  Rgb8 color_at(const Vector2d& at_m, double /*time_s*/) const override {
    constexpr Rgb8 kWood{150, 110, 70}, kGrain{120, 85, 50};
    constexpr double kGrain_m = 0.07;
    return std::lround(std::floor(at_m.x() / kGrain_m)) % 2 == 0 ? kWood : kGrain;
  }

  const DoorOptions swing_;
  const Vector3d hinge_world_;
};

template <class Disturbed, class... More>
Result<std::unique_ptr<dataset::Sequence>> with_pane(std::unique_ptr<dataset::Sequence> sequence,
                                                     const char* name, const PaneOptions& options,
                                                     const More&... more) {
  if (const Status status = check_registered(*sequence, name); !status.ok()) return status.error();
  const Result<Pane> pane = pane_in(*sequence, options);
  if (!pane.ok()) return in_context(name, pane.error());
  return std::unique_ptr<dataset::Sequence>(
      std::make_unique<Disturbed>(std::move(sequence), *pane, more...));
}

}  // namespace

Result<PaneOptions> parse_mirror(const std::string& text) {
  PaneOptions pane{.width_m = 0.8, .height_m = 0.8, .turn_deg = 45};
  const Status status = apply_key_values(text, pane_rules(pane));
  if (!status.ok()) return in_context(kMirror, status.error());
  return pane;
}

Result<PaneOptions> parse_glass(const std::string& text) {
  PaneOptions pane{.width_m = 1, .height_m = 1};
  std::vector<KeyValueRule> rules = pane_rules(pane);
  rules.push_back(number_rule("holes", 0, 1, pane.holes));
  rules.push_back(number_rule("specks", 0, 1, pane.specks));
  rules.push_back(seed_rule(pane.seed));
  const Status status = apply_key_values(text, rules);
  if (!status.ok()) return in_context(kGlass, status.error());
  return pane;
}

Result<Pane> pane_in(const dataset::Sequence& sequence, const PaneOptions& options) {
  const Result<Stage> stage = stage_of(sequence, "pane");
  if (!stage.ok()) return stage.error();
  Pane pane;
  pane.middle_world = stage->world_from_camera * Vector3d(0, 0, options.distance_m);
  pane.up_world = stage->up;
  pane.normal_world =
      Eigen::AngleAxisd(-options.turn_deg * M_PI / 180, stage->up) * -stage->forward;
  pane.across_world = pane.up_world.cross(pane.normal_world);
  pane.half_width_m = options.width_m / 2;
  pane.half_height_m = options.height_m / 2;
  return pane;
}

Result<std::unique_ptr<dataset::Sequence>> with_mirror(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options) {
  const Result<PaneOptions> mirror = parse_mirror(options);
  if (!mirror.ok()) return mirror.error();
  return with_pane<Mirrored>(std::move(sequence), kMirror, *mirror);
}

Result<std::unique_ptr<dataset::Sequence>> with_glass(std::unique_ptr<dataset::Sequence> sequence,
                                                      const std::string& options) {
  const Result<PaneOptions> glass = parse_glass(options);
  if (!glass.ok()) return glass.error();
  return with_pane<Glazed>(std::move(sequence), kGlass, *glass, *glass);
}

Result<std::unique_ptr<dataset::Sequence>> with_screen(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options) {
  PaneOptions pane{.width_m = 1.2, .height_m = 0.7};
  double speed_m_s = 0.3;
  std::vector<KeyValueRule> rules = pane_rules(pane);
  rules.push_back(number_rule("speed_m_s", -10, 10, speed_m_s));
  if (const Status status = apply_key_values(options, rules); !status.ok())
    return in_context(kScreen, status.error());
  return with_pane<Screen>(std::move(sequence), kScreen, pane, speed_m_s);
}

Result<std::unique_ptr<dataset::Sequence>> with_door(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options) {
  PaneOptions pane{.width_m = 0.9, .height_m = 2};
  DoorOptions swing;
  std::vector<KeyValueRule> rules = pane_rules(pane);
  rules.push_back(number_rule("swing_deg", -170, 170, swing.swing_deg));
  rules.push_back(number_rule("period_s", 0.5, 3600, swing.period_s));
  if (const Status status = apply_key_values(options, rules); !status.ok())
    return in_context(kDoor, status.error());
  return with_pane<Door>(std::move(sequence), kDoor, pane, swing);
}

}  // namespace hermite::disturb
