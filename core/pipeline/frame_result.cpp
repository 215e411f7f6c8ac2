#include "core/pipeline/frame_result.h"

namespace hermite::pipeline {

const char* name_of(MapEvent event) {
  switch (event) {
    case MapEvent::kNone: return "";
    case MapEvent::kLost: return "lost";
    case MapEvent::kFoundAgain: return "found again";
    case MapEvent::kNewPart: return "new part";
    case MapEvent::kJoined: return "joined";
    case MapEvent::kLoopClosed: return "loop closed";
    case MapEvent::kRecalibrated: return "recalibrated";
  }
  return "";
}

}  // namespace hermite::pipeline
