#include "core/disturb/light_disturbance.h"

#include <algorithm>
#include <cmath>

#include "core/disturb/color_disturbance.h"
#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/disturb/true_view.h"

namespace hermite::disturb {
namespace {

using Eigen::Vector3d;
using Opened = Result<std::unique_ptr<dataset::Sequence>>;

struct HeadlampOptions {
  double ambient = 0.2, reference_m = 1.8;
};

class Headlamp : public RedrawnSequence {
 public:
  Headlamp(std::unique_ptr<dataset::Sequence> original, const HeadlampOptions& options)
      : RedrawnSequence(std::move(original)), options_(options) {}

 private:
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t /*index*/) const override {
    constexpr double kInCorners = 0.4;  // the cone of the lamp, as a share of its middle
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x) {
        const double depth_m = depth.at(x, y) / camera().depth_units_per_metre;
        if (depth_m == 0) continue;
        const double cone = 1 - (1 - kInCorners) * squared_radius(x, y, color.width, color.height);
        const double lamp = std::pow(options_.reference_m / depth_m, 2) * cone;
        color.at(x, y) =
            multiplied(color.at(x, y), options_.ambient + (1 - options_.ambient) * lamp);
      }
    return Done{};
  }

  const HeadlampOptions options_;
};

// A gain for each point of the scene and each moment.
class SceneLight : public RedrawnSequence {
 public:
  SceneLight(std::unique_ptr<dataset::Sequence> original, const std::string& name,
             const Stage& stage)
      : RedrawnSequence(std::move(original)), stage_(stage), name_(name) {}

 protected:
  const Stage stage_;

 private:
  // `right_m` and `up_m`: of the surface point, from the optical axis of the middle frame, in its
  // image's directions; `time_s` from the first frame.
  virtual double gain(double right_m, double up_m, double time_s) const = 0;

  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const override {
    const Result<Rigid3> pose = true_pose(*original_, timestamp_s(index), name_);
    if (!pose.ok()) return pose.error();
    const double time_s = timestamp_s(index) - timestamp_s(0);
    const Rigid3 middle_from_camera = inverse(stage_.world_from_camera) * *pose;
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x) {
        const double depth_m = depth.at(x, y) / camera().depth_units_per_metre;
        if (depth_m == 0) continue;
        const Vector3d in_middle = middle_from_camera * (depth_m * ray_of(camera(), x, y));
        color.at(x, y) = multiplied(color.at(x, y), gain(in_middle.x(), -in_middle.y(), time_s));
      }
    return Done{};
  }

  const std::string name_;
};

struct LampOptions {
  double at_s = 2, dim = 0.4;
};

class Lamp : public SceneLight {
 public:
  Lamp(std::unique_ptr<dataset::Sequence> original, const Stage& stage, const LampOptions& options)
      : SceneLight(std::move(original), "lamp", stage), options_(options) {}

 private:
  double gain(double right_m, double /*up_m*/, double time_s) const override {
    if (time_s < options_.at_s) return 1;
    const double lit_share = std::clamp(0.5 + right_m, 0.0, 1.0);
    return options_.dim + (1 - options_.dim) * lit_share;
  }

  const LampOptions options_;
};

struct SunOptions {
  double gain = 1.8, width_m = 0.6, speed_m_s = 0.3;
};

class Sun : public SceneLight {
 public:
  Sun(std::unique_ptr<dataset::Sequence> original, const Stage& stage, const SunOptions& options)
      : SceneLight(std::move(original), "sun", stage),
        options_(options),
        middle_s_(stage.middle_s - timestamp_s(0)) {}

 private:
  double gain(double right_m, double up_m, double time_s) const override {
    constexpr double kEdge_m = 0.03;  // half-shadow of the sun's disc
    const double away_m = std::hypot(right_m - options_.speed_m_s * (time_s - middle_s_), up_m);
    const double in_sun = std::clamp((options_.width_m / 2 - away_m) / kEdge_m + 0.5, 0.0, 1.0);
    return 1 + (options_.gain - 1) * in_sun;
  }

  const SunOptions options_;
  const double middle_s_;  // from the first frame
};

struct BalanceOptions {
  double amplitude = 0.2, period_s = 3;
};

class Balanced : public RedrawnSequence {
 public:
  Balanced(std::unique_ptr<dataset::Sequence> original, const BalanceOptions& options)
      : RedrawnSequence(std::move(original)), options_(options) {}

 private:
  Status redraw(DepthImage& /*depth*/, ColorImage& color, std::int64_t index) const override {
    const double time_s = timestamp_s(index) - timestamp_s(0);
    const double tint = options_.amplitude * std::sin(2 * M_PI * time_s / options_.period_s);
    for (Rgb8& pixel : color.pixels) pixel = multiplied(pixel, 1 + tint, 1, 1 - tint);
    return Done{};
  }

  const BalanceOptions options_;
};

template <class Light, class Options>
Opened in_scene(std::unique_ptr<dataset::Sequence> sequence, const char* name,
                const Options& options) {
  if (const Status status = check_registered(*sequence, name); !status.ok()) return status.error();
  const Result<Stage> stage = stage_of(*sequence, name);
  if (!stage.ok()) return stage.error();
  return std::unique_ptr<dataset::Sequence>(
      std::make_unique<Light>(std::move(sequence), *stage, options));
}

}  // namespace

Opened with_headlamp(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  HeadlampOptions headlamp;
  const Status status =
      apply_key_values(options, {number_rule("ambient", 0, 1, headlamp.ambient),
                                 number_rule("reference_m", 0.1, 10, headlamp.reference_m)});
  return when_ok<Headlamp>(status, "headlamp", std::move(sequence), headlamp);
}

Opened with_lamp(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  LampOptions lamp;
  const Status status = apply_key_values(
      options, {number_rule("at_s", 0, 3600, lamp.at_s), number_rule("dim", 0, 1, lamp.dim)});
  if (!status.ok()) return in_context("lamp", status.error());
  return in_scene<Lamp>(std::move(sequence), "lamp", lamp);
}

Opened with_sun(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  SunOptions sun;
  const Status status = apply_key_values(
      options, {number_rule("gain", 1, 4, sun.gain), number_rule("width_m", 0.05, 5, sun.width_m),
                number_rule("speed_m_s", 0, 2, sun.speed_m_s)});
  if (!status.ok()) return in_context("sun", status.error());
  return in_scene<Sun>(std::move(sequence), "sun", sun);
}

Opened with_balance(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  BalanceOptions balance;
  const Status status =
      apply_key_values(options, {number_rule("amplitude", 0, 0.9, balance.amplitude),
                                 number_rule("period_s", 0.01, 3600, balance.period_s)});
  return when_ok<Balanced>(status, "balance", std::move(sequence), balance);
}

}  // namespace hermite::disturb
