// What a scan has come to so far, and what it takes: counts, errors, times and memory.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/adjust/mapping.h"
#include "core/math/camera.h"
#include "core/math/up_direction.h"
#include "core/track/path_noise.h"

namespace hermite::pipeline {

struct Reconstruction;

struct PipelineStatistics {
  std::int64_t frame_count = 0;
  std::int64_t tracked_frame_count = 0;  // includes weakly tracked frames
  std::int64_t weak_frame_count = 0;
  // Frames that arrived incompletely (core/frame/repeated_rows.h). Set by Pipeline::statistics().
  std::int64_t torn_frame_count = 0;
  double position_sigma_m = 0, rotation_sigma_rad = 0;  // of the last tracked frame
  // Nullopt: no frame was tracked, or components are not joined.
  std::optional<track::ExpectedError> expected_error;
  // Nullopt without an accelerometer, or with `up_problem`: why its values cannot be used.
  std::optional<UpDirection> up;
  std::string up_problem;
  std::string calibration_doubt;  // as text; empty: the camera fits its views
  // As text; empty: the given calibration is in use. This and the next two are set by
  // Pipeline::statistics().
  std::string camera_correction;
  std::optional<Camera> corrected_camera;  // set when the calibration was corrected
  // The camera in use, with the standard deviations of what may still be wrong with it: for the
  // next scan with the same device.
  Camera known_camera;
  std::int64_t surfel_count = 0;
  std::int64_t surfel_slot_count = 0;  // in use or free again
  std::int64_t surfel_capacity = 0;    // slots with allocated memory
  // Wall clock inside Pipeline::process(); this and the next two since restore().
  double mean_frame_ms = 0;
  std::map<std::string, double> stages_ms;  // mean per frame, by stage
  // Mean per frame, by shader; GPU time stamps.
  std::map<std::string, double> gpu_passes_ms;
  std::map<std::string, std::int64_t> gpu_memory_bytes;  // by purpose
  // Total memory of the device; 0: unknown, the device is a CPU.
  std::int64_t device_memory_bytes = 0;
  std::int64_t host_memory_bytes = 0;            // of submaps moved to the host
  std::optional<adjust::MappingCounts> mapping;  // nullopt without mapping
  std::string device;
};

// Returns the statistics of one reconstruction, without corrections of its camera. Call it on the
// thread that owns the reconstruction.
PipelineStatistics statistics_of(const Reconstruction& now);

}  // namespace hermite::pipeline
