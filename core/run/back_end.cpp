#include "core/run/back_end.h"

#include "core/calibrate/camera_watch.h"

namespace hermite {

BackEnd make_back_end(const Options& options, CorrectionTime time) {
  BackEnd back_end;
  back_end.mapping = [adjust = options.adjust, time](const Camera& camera) { return make_mapping(camera, adjust, time); };
  back_end.camera_watch = make_camera_watch;
  return back_end;
}

}  // namespace hermite
