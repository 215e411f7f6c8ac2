// Follows whether the light of the scene changes as a whole, as when a lamp goes out: the colours
// of the map are then wrong, however often they were seen, and are replaced. Light that moves
// across surfaces is something else (light_changes.h).
//
// Runs on the host. One thread at a time.
#pragma once

#include "core/base/byte_stream.h"
#include "core/frame/brightness.h"
#include "core/track/judgement.h"

namespace hermite::track {

class NewLight {
 public:
  // `frames`: in how many frames every pixel is sampled once, at least 1.
  explicit NewLight(int frames) : frames_(frames) {}

  // Tells the evidence of a frame what is known from those before it.
  void describe(TrackingEvidence& evidence) const {
    evidence.follows_good_image = follows_good_image_;
    evidence.is_light_new = frames_left_ > 0;
  }

  // Takes the judgement of that frame and its brightness relative to the map. In new light this
  // cannot be told, and becomes that of the last frame whose image was like the map's, since the
  // camera's exposure hardly changes from one frame to the next. Returns whether the light has
  // changed: earlier views of the same surfaces must not be compared with this one.
  bool follow(const Judgement& judgement, frame::Brightness& brightness);

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  const int frames_;
  bool follows_good_image_ = false;    // see TrackingEvidence
  std::int32_t frames_left_ = 0;       // after this one, of those whose colours replace the map's
  frame::Brightness good_brightness_;  // of the last frame whose image was like the map's
};

}  // namespace hermite::track
