#include "core/disturb/moving_person.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/disturb/depth_units.h"
#include "core/disturb/key_values.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/disturb/true_view.h"

namespace hermite::disturb {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_m = 0.25, kHeight_m = 1.75, kHeadAboveCamera_m = 0.15;
constexpr double kSpeed_m_s = 0.8;
constexpr double kAheadDistance_m = 1.7;
constexpr double kMinDepth_m = 0.3;
constexpr double kCheckAngle_rad = 0.4, kCheckHeight_m = 0.1;
constexpr Rgb8 kLightCheck{180, 190, 200}, kDarkCheck{60, 45, 40}, kPlainCloth{120, 110, 90};
constexpr const char* kPersonName = "person";

Person placed(const Stage& stage, const PersonOptions& options, const Rigid3& world_from_camera,
              double time_s) {
  Person person{Vector3d::Zero(), kRadius_m, kHeight_m, stage.up};
  if (options.path == PersonPath::kCross)
    person.head_world = stage.world_from_camera.translation + options.distance_m * stage.forward +
                        kSpeed_m_s * (time_s - stage.middle_s) * stage.side;
  else
    person.head_world = world_from_camera.translation +
                        options.distance_m * forward_of(world_from_camera, stage.up);
  person.head_world += kHeadAboveCamera_m * stage.up;
  return person;
}

Result<Person> person_of(const dataset::Sequence& sequence, const Stage& stage,
                         const PersonOptions& options, std::int64_t index) {
  const double time_s =
      std::max(sequence.timestamp_s(index), sequence.timestamp_s(0) + options.still_s);
  const Result<Rigid3> pose = true_pose(sequence, time_s, kPersonName);
  if (!pose.ok()) return pose.error();
  return placed(stage, options, *pose, time_s);
}

// Returns the multiple of `direction` at which a ray from outside enters the person.
std::optional<double> enters(const Person& person, const Vector3d& origin,
                             const Vector3d& direction) {
  const Vector3d from_head = origin - person.head_world;
  const double rise = direction.dot(person.up_world), height_m = from_head.dot(person.up_world);
  const Vector3d across = direction - rise * person.up_world,
                 away_m = from_head - height_m * person.up_world;
  const double a = across.squaredNorm(), b = across.dot(away_m),
               c = away_m.squaredNorm() - person.radius_m * person.radius_m;
  const double discriminant = b * b - a * c;
  if (discriminant > 0) {
    const double s = (-b - std::sqrt(discriminant)) / a, above_m = height_m + s * rise;
    if (s > 0 && above_m <= 0 && above_m >= -person.height_m) return s;
  }
  if (height_m <= 0 || rise >= 0) return std::nullopt;
  const double s = -height_m / rise;
  if ((away_m + s * across).norm() <= person.radius_m) return s;
  return std::nullopt;
}

Rgb8 cloth_at(const Vector3d& from_head, const Stage& stage, PersonClothes clothes) {
  if (clothes == PersonClothes::kPlain) return kPlainCloth;
  const double angle = std::atan2(from_head.dot(stage.side), from_head.dot(stage.forward));
  const auto check = std::lround(std::floor(angle / kCheckAngle_rad) +
                                 std::floor(from_head.dot(stage.up) / kCheckHeight_m));
  return check % 2 == 0 ? kLightCheck : kDarkCheck;
}

class Crowded : public RedrawnSequence {
 public:
  Crowded(std::unique_ptr<dataset::Sequence> original, const PersonOptions& options,
          const Stage& stage)
      : RedrawnSequence(std::move(original)), options_(options), stage_(stage) {}

 private:
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const override {
    const Result<Rigid3> pose = true_pose(*original_, timestamp_s(index), kPersonName);
    if (!pose.ok()) return pose.error();
    const Result<Person> person = person_of(*original_, stage_, options_, index);
    if (!person.ok()) return person.error();
    render(*person, *pose, depth, color);
    return Done{};
  }

  void render(const Person& person, const Rigid3& world_from_camera, DepthImage& depth,
              ColorImage& color) const {
    const Eigen::Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
    const double scale = camera().depth_units_per_metre;
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x) {
        const Vector3d direction = rotation * ray_of(camera(), x, y);
        const std::optional<double> depth_m =
            enters(person, world_from_camera.translation, direction);
        std::uint16_t& seen = depth.at(x, y);
        if (!depth_m || *depth_m < kMinDepth_m || (seen > 0 && *depth_m * scale >= seen)) continue;
        seen = to_depth_units(*depth_m, scale);
        color.at(x, y) =
            cloth_at(world_from_camera.translation + *depth_m * direction - person.head_world,
                     stage_, options_.clothes);
      }
  }

  const PersonOptions options_;
  const Stage stage_;
};

}  // namespace

Result<PersonOptions> parse_person(const std::string& text) {
  PersonOptions options;
  double distance_m = 0;
  const auto take_path = [&](std::string_view value) {
    options.path = value == "ahead" ? PersonPath::kAhead : PersonPath::kCross;
    return value == "ahead" || value == "cross";
  };
  const auto take_clothes = [&](std::string_view value) {
    options.clothes = value == "plain" ? PersonClothes::kPlain : PersonClothes::kChecked;
    return value == "plain" || value == "checked";
  };
  const Status status = apply_key_values(text, {{"path", "cross or ahead", take_path},
                                                {"clothes", "checked or plain", take_clothes},
                                                number_rule("distance_m", 0.6, 10, distance_m),
                                                number_rule("still_s", 0, 60, options.still_s)});
  if (!status.ok()) return in_context(kPersonName, status.error());
  if (distance_m > 0)
    options.distance_m = distance_m;
  else if (options.path == PersonPath::kAhead)
    options.distance_m = kAheadDistance_m;
  return options;
}

Result<Person> person_at(const dataset::Sequence& sequence, const PersonOptions& options,
                         std::int64_t frame_index) {
  const Result<Stage> stage = stage_of(sequence, kPersonName);
  if (!stage.ok()) return stage.error();
  return person_of(sequence, *stage, options, frame_index);
}

Result<std::unique_ptr<dataset::Sequence>> with_person(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options) {
  const Result<PersonOptions> person = parse_person(options);
  if (!person.ok()) return person.error();
  if (const Status status = check_registered(*sequence, kPersonName); !status.ok())
    return status.error();
  const Result<Stage> stage = stage_of(*sequence, kPersonName);
  if (!stage.ok()) return stage.error();
  return std::unique_ptr<dataset::Sequence>(
      std::make_unique<Crowded>(std::move(sequence), *person, *stage));
}

}  // namespace hermite::disturb
