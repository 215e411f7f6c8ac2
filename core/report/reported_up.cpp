#include "core/report/reported_up.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace hermite::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kUp = "up", *kInWorld = "in_world", *kSigma = "sigma_deg";
constexpr double kDegree = M_PI / 180;

}  // namespace

void report_up(const UpDirection& up, Json& report) {
  report[kUp] = {{kInWorld, {up.in_world.x(), up.in_world.y(), up.in_world.z()}},
                 {kSigma, up.sigma_rad / kDegree}};
}

std::optional<UpDirection> up_in_report(const std::string& report_json) {
  const Json report = Json::parse(report_json, nullptr, false);
  const Json up = report.is_object() ? report.value(kUp, Json()) : Json();
  const Json axes = up.is_object() ? up.value(kInWorld, Json()) : Json();
  const Json sigma = up.is_object() ? up.value(kSigma, Json()) : Json();
  const auto is_number = [](const Json& value) { return value.is_number(); };
  if (!axes.is_array() || axes.size() != 3 || !std::ranges::all_of(axes, is_number) ||
      !sigma.is_number())
    return std::nullopt;
  const Eigen::Vector3d in_world(axes[0].get<double>(), axes[1].get<double>(),
                                 axes[2].get<double>());
  const double sigma_rad = sigma.get<double>() * kDegree;
  if (!(std::abs(in_world.norm() - 1) < 1e-3) || !(sigma_rad >= 0)) return std::nullopt;
  return UpDirection{in_world.normalized(), sigma_rad};
}

}  // namespace hermite::report
