#include "core/run/back_end.h"

#include "core/calibrate/camera_watch.h"

namespace hermite::run {

pipeline::BackEnd make_back_end(const pipeline::Options& options, adjust::CorrectionTime time) {
  pipeline::BackEnd back_end;
  back_end.mapping = [adjust = options.adjust, time](const Camera& camera) {
    return adjust::make_mapping(camera, adjust, time);
  };
  back_end.camera_watch = calibrate::make_camera_watch;
  return back_end;
}

}  // namespace hermite::run
