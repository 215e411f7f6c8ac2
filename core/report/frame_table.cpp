#include "core/report/frame_table.h"

#include <cstdio>

namespace hermite {

std::string format_frame_table(const std::vector<FrameRow>& rows) {
  std::string table = "frame,timestamp_s,status,event,correction_m,inlier_ratio,residual_rms_m,surfels,ms,reason\n";
  for (const FrameRow& row : rows) {
    const FrameResult& result = row.result;
    char numbers[2][160];
    std::snprintf(numbers[0], sizeof numbers[0], "%lld,%.6f", static_cast<long long>(result.frame_index), result.timestamp_s);
    std::snprintf(numbers[1], sizeof numbers[1], "%.4f,%.4f,%.6f,%lld,%.1f", result.correction_m, result.inlier_ratio,
                  result.residual_rms_m, static_cast<long long>(result.surfel_count), row.ms);
    table += std::string(numbers[0]) + "," + name_of(result.status) + "," + name_of(result.event) + "," + numbers[1] + ",\"" +
             result.reason + "\"\n";
  }
  return table;
}

}  // namespace hermite
