// Corners followed over many frames, and which of them move on their own. Frame to frame somebody who walks slowly hardly differs from
// noise; over a third of a second he does.
//
// Host only, no GPU. One thread at a time.
#pragma once

#include <functional>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/picture_features.h"
#include "core/math/camera.h"
#include "core/track/corner_split.h"
#include "core/track/feature_motion.h"

namespace hermite {

// A corner that is followed, where the frame shows it.
struct SeenCorner {
  Eigen::Vector2d pixel;  // of the image
  bool moves = false;     // on its own
};

struct CornerVerdict {
  std::vector<SeenCorner> corners;              // whose depth is known
  std::vector<FollowedCorner> resting, moving;  // since the last frame, of those
  std::size_t count = 0;                        // of the corners of the last frame, followed or not
  std::optional<Rigid3> last_from_frame;        // of what rests, only with keeps_moving; nothing: too few corners tell
  double moving_share = 0;                      // of the surface that corners stand for, 0 to 1, over the longest time that tells
  bool is_divided = false;                      // over that time no motion explains most of the surface
  bool moves_now = false;                       // something is seen to move, and does not only bear the name
};

class CornerTracks {
 public:
  // `camera` is that of straight frames. What has moved rests again once it has rested for a while, or, with `keeps_moving`, only once it
  // rests while other things move: what is scanned on a turntable is the same thing when the table stops.
  explicit CornerTracks(const Camera& camera, bool keeps_moving = false) : camera_(camera), keeps_moving_(keeps_moving) {}

  // Where the corners of the last frame are in this one. Changes nothing that remember() does not take up.
  CornerVerdict follow(const PictureFeatures& last, const PictureFeatures& frame);

  // The frame that was followed into becomes the last one. `depth_m` is what the frame measures at a pixel of the image, 0: nothing;
  // `is_moving` says where new corners are taken to move.
  void remember(const PictureFeatures& frame, const std::function<float(int, int)>& depth_m,
                const std::function<bool(int, int)>& is_moving);

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  struct Place {
    float x = 0, y = 0;  // pixels of PictureFeatures::levels[0]
    float depth_m = 0;   // 0: unknown
  };
  struct Track {
    std::vector<Place> past;  // newest first
    std::uint32_t rested_frames = 0;
    bool moves = false;
  };
  struct Baseline;
  Baseline since(std::size_t frames) const;
  void label(CornerVerdict& verdict);
  void collect(CornerVerdict& verdict) const;

  Camera camera_;
  bool keeps_moving_;
  std::vector<Track> tracks_;
  // Of follow(), by track.
  std::vector<std::optional<Eigen::Vector2d>> places_;
  std::vector<std::uint8_t> moves_, rests_;
  int image_px_ = 1;
};

}  // namespace hermite
