// Corners followed over many frames, and which of them move on their own. From one frame to the
// next, a person who walks slowly hardly differs from noise; over a third of a second the motion is
// significant.
//
// Runs on the host. One thread at a time.
#pragma once

#include <functional>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/image_features.h"
#include "core/math/camera.h"
#include "core/track/corner_split.h"
#include "core/track/feature_motion.h"

namespace hermite::track {

// Position of a followed corner in the frame.
struct SeenCorner {
  Eigen::Vector2d pixel;  // of the image
  bool moves = false;     // on its own
};

struct CornerVerdict {
  std::vector<SeenCorner> corners;              // those whose depth is known
  std::vector<FollowedCorner> resting, moving;  // of these, with their points in the last frame
  std::size_t count = 0;                        // of all corners of the last frame, followed or not
  // Motion of the resting corners, only with keeps_moving; std::nullopt: too few corners.
  std::optional<Rigid3> last_from_frame;
  // Share of the corners' surface, 0 to 1, over the longest baseline with enough corners.
  double moving_share = 0;
  // Over that baseline no motion explains most of the surface.
  bool is_divided = false;
  // Motion was measured in this frame, not only carried over from earlier ones.
  bool moves_now = false;
};

class CornerTracks {
 public:
  // `camera` is that of rectified frames. A corner that moved counts as resting once it has not
  // moved for a while; with `keeps_moving`, only once it rests while other corners move: an object
  // on a turntable is still the same object when the turntable stops.
  explicit CornerTracks(const Camera& camera, bool keeps_moving = false)
      : camera_(camera), keeps_moving_(keeps_moving) {}

  // Finds the corners of the last frame in this one. The result is kept only if remember() follows.
  CornerVerdict follow(const frame::ImageFeatures& last, const frame::ImageFeatures& frame);

  // Makes the frame that was followed the last one. `depth_m` returns the measured depth at an
  // image pixel, 0 if there is none; `is_moving` returns whether new corners there are taken to
  // move.
  void remember(const frame::ImageFeatures& frame, const std::function<float(int, int)>& depth_m,
                const std::function<bool(int, int)>& is_moving);

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  struct Place {
    float x = 0, y = 0;  // pixels of ImageFeatures::levels[0]
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
  // Results of follow(), by track.
  std::vector<std::optional<Eigen::Vector2d>> places_;
  std::vector<std::uint8_t> moves_, rests_;
  int image_px_ = 1;
};

}  // namespace hermite::track
