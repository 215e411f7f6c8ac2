// Plays a recording as if its camera were attached, each frame at its time, to try out scanning
// without a camera.
#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "server/capture/camera.h"

namespace hermite::client {

// Waits for no consumer, but drops nothing either: frames that are fetched late are late. Frames
// that cannot be read are skipped. At the end next() returns kNotFound.
std::unique_ptr<CaptureCamera> play_recording(std::unique_ptr<dataset::Sequence> sequence);

}  // namespace hermite::client
