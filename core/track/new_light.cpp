#include "core/track/new_light.h"

#include <algorithm>
#include <cmath>

namespace hermite::track {

bool NewLight::follow(const Judgement& judgement, frame::Brightness& brightness) {
  const bool is_first = judgement.light_has_changed && frames_left_ == 0;
  frames_left_ = is_first ? frames_ - 1 : std::max(0, frames_left_ - 1);
  if (judgement.light_has_changed)
    brightness = good_brightness_;
  else if (judgement.image_is_good)
    good_brightness_ = brightness;
  follows_good_image_ =
      judgement.status != TrackingStatus::kLost && (follows_good_image_ || judgement.image_is_good);
  return judgement.light_has_changed;
}

void NewLight::save(ByteWriter& bytes) const {
  bytes.flag(follows_good_image_);
  bytes.number(frames_left_);
  bytes.number(good_brightness_.gain);
  bytes.number(good_brightness_.offset);
}

void NewLight::restore(ByteReader& bytes) {
  bytes.flag(follows_good_image_);
  bytes.number(frames_left_);
  bytes.number(good_brightness_.gain);
  bytes.number(good_brightness_.offset);
  bytes.require(frames_left_ >= 0 && frames_left_ < frames_ &&
                    std::isfinite(good_brightness_.gain) && std::isfinite(good_brightness_.offset),
                "the light of the last frames");
}

}  // namespace hermite::track
