#include "core/pipeline/camera_doubts.h"

#include <algorithm>

namespace hermite::pipeline {

track::CameraDoubts doubts_of(const calibrate::ShapeErrors& errors) {
  track::CameraDoubts doubts;
  doubts[track::kBendDoubt] = errors.bend;
  doubts[track::kFocalDoubt] = errors.focal;
  doubts[track::kRadialDoubt] = errors.k1;
  return doubts;
}

CameraDeviations deviations_of(const track::CameraDoubts& doubts) {
  const track::CameraDoubts valid = doubts.cwiseMin(kMaxCameraDeviation);
  return {valid[track::kBendDoubt], valid[track::kFocalDoubt], valid[track::kRadialDoubt]};
}

track::CameraDoubts believed(const CameraDeviations& stated) {
  const auto at_least = [](double deviation, double least) {
    return deviation > 0 ? std::max(deviation, least) : 0;
  };
  using calibrate::kFitting;
  return doubts_of({.bend = at_least(stated.bend, kFitting.bend),
                    .focal = at_least(stated.focal, kFitting.focal),
                    .k1 = at_least(stated.k1, kFitting.k1)});
}

}  // namespace hermite::pipeline
