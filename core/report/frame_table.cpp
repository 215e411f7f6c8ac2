#include "core/report/frame_table.h"

#include <fmt/core.h>

#include <cmath>

#include "core/base/printf_text.h"
#include "core/report/stated_uncertainty.h"

namespace hermite::report {

namespace {

std::string stated_fields(const std::optional<track::PoseUncertainty>& uncertainty) {
  if (!uncertainty) return ",,";
  std::string covariance;
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = i; j < 6; ++j)
      covariance +=
          printf_text(covariance.empty() ? "%.4e" : " %.4e", uncertainty->second_moment(i, j));
  return printf_text("%.6f,%.5f,", uncertainty->position_sigma_m(),
                     uncertainty->rotation_sigma_rad() * 180 / M_PI) +
         covariance;
}

std::string error_fields(const std::optional<StatedError>& error) {
  if (!error) return ",,";
  return printf_text("%.6f,%.5f,%.3f", error->position_m, error->rotation_rad * 180 / M_PI,
                     error->pose_sigmas);
}

}  // namespace

std::string format_frame_table(const std::vector<FrameRow>& rows,
                               const dataset::Trajectory& groundtruth) {
  std::string table =
      "frame,timestamp_s,status,event,correction_m,inlier_ratio,residual_rms_m,surfels,ms,reason,"
      "position_sigma_m,rotation_sigma_deg,"
      "covariance,position_error_m,rotation_error_deg,error_sigmas\n";
  const std::vector<std::optional<StatedError>> errors = stated_errors(rows, groundtruth);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const pipeline::FrameResult& result = rows[i].result;
    table += fmt::format("{},{:.6f},{},{},{:.4f},{:.4f},{:.6f},{},{:.1f},\"{}\",{},{}\n",
                         result.frame_index, result.timestamp_s, name_of(result.status),
                         name_of(result.event), result.correction_m, result.inlier_ratio,
                         result.residual_rms_m, result.surfel_count, rows[i].ms, result.reason,
                         stated_fields(result.uncertainty), error_fields(errors[i]));
  }
  return table;
}

}  // namespace hermite::report
