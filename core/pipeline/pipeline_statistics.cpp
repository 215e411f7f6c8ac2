#include "core/pipeline/pipeline_statistics.h"

#include <algorithm>

#include "core/pipeline/reconstruction.h"

namespace hermite::pipeline {

PipelineStatistics statistics_of(const Reconstruction& now) {
  PipelineStatistics statistics;
  statistics.frame_count = static_cast<std::int64_t>(now.poses.size());
  statistics.tracked_frame_count = now.tracked_frame_count;
  statistics.weak_frame_count = now.weak_frame_count;
  statistics.position_sigma_m = now.uncertainty.position_sigma_m();
  statistics.rotation_sigma_rad = now.uncertainty.rotation_sigma_rad();
  const std::vector<std::uint32_t>& component = now.layout().component;
  if (now.tracked_frame_count > 0 &&
      std::ranges::all_of(component, [&](std::uint32_t of) { return of == component.front(); }))
    statistics.expected_error = now.front_end.certainty().expected_error(ground_of(now.layout()));
  FeltUp felt = now.gravity.in_world(now.layout());
  statistics.up = felt.up;
  statistics.up_problem = std::move(felt.problem);
  statistics.calibration_doubt = now.front_end.calibration_doubt().reason();
  statistics.surfel_count = now.front_end.store.surfel_count();
  statistics.surfel_slot_count = now.front_end.store.slot_count();
  statistics.surfel_capacity = now.front_end.store.capacity();
  const double frames = static_cast<double>(std::max<std::int64_t>(now.timed_frame_count, 1));
  statistics.mean_frame_ms = now.total_ms / frames;
  for (const auto& [stage, ms] : now.stage_total_ms) statistics.stages_ms[stage] = ms / frames;
  for (const auto& pass : now.front_end.device.pass_times())
    statistics.gpu_passes_ms[pass.kernel] = pass.total_ms / frames;
  statistics.gpu_memory_bytes = now.front_end.device.memory_by_purpose();
  const gpu::DeviceInfo& device = now.front_end.device.info();
  if (device.kind != gpu::DeviceKind::kCpu)
    statistics.device_memory_bytes = static_cast<std::int64_t>(device.all_memory_bytes);
  statistics.host_memory_bytes = now.front_end.store.host_bytes();
  if (now.mapping) statistics.mapping = now.mapping->counts();
  statistics.device = device.name;
  return statistics;
}

}  // namespace hermite::pipeline
