// Opens what a user names: a recording or a synthetic scene, disturbed or not.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::source {

// `source` is a folder, file or archive (recording.h: the format is detected by content) or
// "synthetic[:key=value,...]" (synthetic_camera.h).
//
// The camera is `camera` if given, else the folder's camera.json, else from its own files (7-Scenes
// camera-intrinsics.txt), else one by a well-known name (freiburg1, 2, 3; ICL-NUIM); none of these
// is an error that says so. The depth camera that 7-Scenes names gets the colour camera of its
// Kinect, unless `camera` is given or camera.json has a color_camera.
//
// Colour and depth are paired by time, at most 20 ms apart, each image used once.
//
// Up to 16 disturbances may be appended to either, applied from left to right; their options are
// "key=value,...", and if all have a default, the name alone suffices:
//   +noise=MODEL[,...]                        depth_noise.h
//   +covered=FROM:COUNT +missing=FROM:COUNT   disturbance.h
//   +exposure +flicker +vignetting            color_disturbance.h
//   +person                                   moving_person.h
//   +bend +sparse +reach +focal +skip         depth_disturbance.h
//   +lens                                     lens_disturbance.h
//   +rolling +clock +blur                     shutter_disturbance.h
//   +mirror +glass +screen +door              pane_disturbance.h
//   +flying +lowres +speckle +frozen          sensor_disturbance.h
//   +misregistered +banding +dark             sensor_disturbance.h
//   +headlamp +lamp +sun +balance             light_disturbance.h
//   +attached +torn +stained                  rig_disturbance.h
//   +warming +jitter                          rig_disturbance.h
//   +turned +accelerometer                    held_disturbance.h
Result<std::unique_ptr<dataset::Sequence>> open_sequence(
    const std::string& source, const std::optional<Camera>& camera = std::nullopt);

// Returns the part before the first disturbance.
std::string source_without_suffixes(const std::string& source);

}  // namespace hermite::source
