// A recording played as if its camera were attached: each frame at its time. To try out scanning without a camera.
#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "server/capture/camera.h"

namespace hermite {

// Waits for nobody, but leaves nothing out either: when frames are fetched late, they come late. Frames that cannot be read are left out.
// At the end next() is kNotFound.
std::unique_ptr<CaptureCamera> play_recording(std::unique_ptr<Sequence> sequence);

}  // namespace hermite
