#include "core/track/corner_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hermite::track::corner_tracks_test {
namespace {

const Camera kCamera{240, 180, 197, 197, 119.5, 89.5, 5000};

constexpr bool on_board(int x, int y) { return x > 80 && x < 160 && y > 40 && y < 140; }

int grey_of(double x, double y) {
  return static_cast<int>(128 + 60 * std::sin(0.35 * x + 0.9 * std::sin(0.11 * y)) *
                                    std::sin(0.31 * y + 0.7 * std::sin(0.13 * x)));
}

// A papered wall 2 m away that has gone `wall_px` to the left, and before it, 1 m away, a board
// that has gone `board_px`.
frame::RgbdFrame frame_of(double wall_px, double board_px) {
  frame::RgbdFrame frame{0, DepthImage(240, 180), ColorImage(240, 180)};
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 240; ++x) {
      const auto grey = static_cast<std::uint8_t>(
          on_board(x, y) ? grey_of(500 + x + board_px, 300 + y) : grey_of(x + wall_px, y));
      frame.color.at(x, y) = {grey, grey, grey};
      frame.depth.at(x, y) = on_board(x, y) ? 5000 : 10000;
    }
  return frame;
}

struct Seen {
  double of_board = 0, of_wall = 0;  // shares of the corners on each that move
  CornerVerdict verdict;
};

class CornerFilm {
 public:
  explicit CornerFilm(bool keeps_moving = false) : tracks(kCamera, keeps_moving) {}

  Seen show(double wall_px, double board_px) {
    const frame::RgbdFrame frame = frame_of(wall_px, board_px);
    const frame::ImageFeatures features = frame::features_of(frame, 5000, {});
    Seen seen{0, 0, tracks.follow(last_, features)};
    double board = 0, wall = 0;
    for (const SeenCorner& corner : seen.verdict.corners) {
      const bool of_board =
          on_board(static_cast<int>(corner.pixel.x()), static_cast<int>(corner.pixel.y()));
      (of_board ? board : wall) += 1;
      (of_board ? seen.of_board : seen.of_wall) += corner.moves ? 1 : 0;
    }
    seen.of_board /= std::max(1.0, board);
    seen.of_wall /= std::max(1.0, wall);
    tracks.remember(
        features, [&](int x, int y) { return frame::depth_around(frame.depth, x, y, 5000, {}); },
        [](int, int) { return false; });
    last_ = features;
    return seen;
  }

  CornerTracks tracks;

 private:
  frame::ImageFeatures last_;
};

TEST(CornerTracks, TellTheBoardThatGoesAlong) {
  CornerFilm film;
  for (int i = 0; i < 10; ++i) {
    const Seen seen = film.show(3 * i, 0);
    if (i == 0) continue;
    EXPECT_GT(seen.of_board, 0.8) << i;
    EXPECT_LT(seen.of_wall, 0.1) << i;
    EXPECT_FALSE(seen.verdict.is_divided) << i;
    EXPECT_TRUE(seen.verdict.moves_now) << i;
    EXPECT_GE(seen.verdict.count, seen.verdict.corners.size());
    EXPECT_EQ(seen.verdict.corners.size(),
              seen.verdict.resting.size() + seen.verdict.moving.size());
    EXPECT_FALSE(seen.verdict.last_from_frame.has_value());
  }
}

// Half a pixel is no more than following may be off by, four pixels are.
TEST(CornerTracks, TellASlowMotionAfterAWhile) {
  CornerFilm film;
  for (int i = 0; i < 12; ++i) {
    const Seen seen = film.show(0, 0.5 * i);
    if (i < 2) {
      EXPECT_LT(seen.of_board, 0.2) << i;
    }
    if (i > 9) {
      EXPECT_GT(seen.of_board, 0.4) << i;
    }
    EXPECT_LT(seen.of_wall, 0.1) << i;
  }
}

TEST(CornerTracks, LetWhatMovedRestAfterASecond) {
  for (const bool keeps_moving : {false, true}) {
    CornerFilm film(keeps_moving);
    for (int i = 0; i < 6; ++i) film.show(0, 2 * i);
    EXPECT_GT(film.show(0, 12).of_board, 0.5);
    for (int i = 0; i < 15; ++i) film.show(0, 12);
    EXPECT_GT(film.show(0, 12).of_board, 0.5) << "not at once";
    for (int i = 0; i < 30; ++i) film.show(0, 12);
    const Seen seen = film.show(0, 12);
    EXPECT_FALSE(seen.verdict.moves_now);
    if (keeps_moving)
      EXPECT_GT(seen.of_board, 0.5) << "an object is the same thing when it stops";
    else
      EXPECT_EQ(seen.of_board, 0);
    EXPECT_EQ(seen.verdict.last_from_frame.has_value(), keeps_moving);
  }
}

TEST(CornerTracks, GoOnFromWhatWasSaved) {
  CornerFilm before;
  for (int i = 0; i < 5; ++i) before.show(3 * i, 0);
  ByteWriter bytes;
  before.tracks.save(bytes);
  const std::string saved = bytes.take();
  CornerTracks after(kCamera);
  ByteReader reader(saved);
  after.restore(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  const frame::ImageFeatures last = frame::features_of(frame_of(12, 0), 5000, {}),
                             now = frame::features_of(frame_of(15, 0), 5000, {});
  const CornerVerdict expected = before.tracks.follow(last, now), verdict = after.follow(last, now);
  ASSERT_EQ(verdict.corners.size(), expected.corners.size());
  ASSERT_FALSE(verdict.corners.empty());
  for (std::size_t i = 0; i < verdict.corners.size(); ++i) {
    EXPECT_EQ(verdict.corners[i].pixel, expected.corners[i].pixel);
    EXPECT_EQ(verdict.corners[i].moves, expected.corners[i].moves);
  }
  for (std::size_t size = 0; size < saved.size(); size += 97) {
    CornerTracks cut(kCamera);
    ByteReader short_reader(std::string_view(saved).substr(0, size));
    cut.restore(short_reader);
    EXPECT_FALSE(short_reader.ok()) << size;
  }
}

}  // namespace
}  // namespace hermite::track::corner_tracks_test
