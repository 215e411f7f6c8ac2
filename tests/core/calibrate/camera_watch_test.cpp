#include "core/calibrate/camera_watch.h"

#include <gtest/gtest.h>

#include <string>

#include "core/source/open_sequence.h"

namespace hermite::calibrate {
namespace {

// A camera that is 2 % off, with its true poses.
class Walk {
 public:
  explicit Walk(const char* source =
                    "synthetic:scene=bare,frames=60,width=160,height=120,rate=10+focal=percent=2")
      : sequence_(*source::open_sequence(source)), watch(make_camera_watch(sequence_->camera())) {}

  bool is_over() const { return next_ == sequence_->frame_count(); }
  std::int64_t frame_count() const { return next_; }

  std::optional<CameraCheck> take_frame() {
    const Rigid3& pose =
        sequence_->groundtruth()[static_cast<std::size_t>(next_)].world_from_camera;
    const dataset::Trajectory& truth = sequence_->groundtruth();
    const auto here = static_cast<std::size_t>(next_);
    watch->step(truth[here].timestamp_s,
                here == 0 ? std::nullopt
                          : std::optional(inverse(truth[here - 1].world_from_camera) * pose));
    frame::RgbdFrame frame = *dataset::decode_frame(*sequence_->read(next_++));
    if (watch->wants(pose)) {
      watch->view(std::move(frame), pose);
      ++view_count;
    }
    return watch->answer();
  }

 private:
  const std::unique_ptr<dataset::Sequence> sequence_;
  std::int64_t next_ = 0;

 public:
  std::unique_ptr<CameraWatch> watch;
  int view_count = 0;

  void go_on_with(std::unique_ptr<CameraWatch> another) { watch = std::move(another); }
  const Camera& camera() const { return sequence_->camera(); }
};

TEST(CameraWatch, AnswersOnceAndIsSatisfied) {
  Walk walk;
  std::optional<CameraCheck> answer;
  while (!answer && !walk.is_over()) answer = walk.take_frame();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->verdict, CameraVerdict::kIsOff);
  EXPECT_NEAR(answer->change[kFocal], -0.0198, 0.003);
  const int views_before = walk.view_count;
  while (!walk.is_over()) EXPECT_FALSE(walk.take_frame());
  EXPECT_EQ(walk.view_count, views_before) << "nobody needs to know any more";
  EXPECT_FALSE(walk.watch->last_answer());
}

TEST(CameraWatch, GoesOnFromAnyFrameToTheSameAnswerAtTheSameFrame) {
  Walk whole;
  std::optional<CameraCheck> expected;
  while (!expected) expected = whole.take_frame();
  for (const std::int64_t broken_off : {std::int64_t{3}, whole.frame_count() - 8}) {
    Walk walk;
    while (walk.frame_count() < broken_off) ASSERT_FALSE(walk.take_frame());
    ByteWriter saved;
    walk.watch->save(saved);
    const std::string bytes = saved.take();
    walk.go_on_with(make_camera_watch(walk.camera()));
    ByteReader reader(bytes);
    walk.watch->restore(reader);
    ASSERT_TRUE(reader.ok() && reader.at_end());
    std::optional<CameraCheck> answer;
    while (!answer && !walk.is_over()) answer = walk.take_frame();
    EXPECT_EQ(walk.frame_count(), whole.frame_count());
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->change, expected->change);
  }
}

TEST(CameraWatch, RefusesWhatIsNoStateOfIt) {
  Walk walk;
  for (int i = 0; i < 8; ++i) walk.take_frame();
  ByteWriter saved;
  walk.watch->save(saved);
  const std::string bytes = saved.take();
  const auto is_refused = [](const std::string& state, const Camera& camera) {
    const auto watch = make_camera_watch(camera);
    ByteReader reader(state);
    watch->restore(reader);
    return !reader.ok();
  };
  EXPECT_FALSE(is_refused(bytes, walk.camera()));
  EXPECT_TRUE(is_refused(bytes.substr(0, bytes.size() - 1), walk.camera()));
  Camera larger = walk.camera();
  larger.width = 320;
  EXPECT_TRUE(is_refused(bytes, larger));
}

TEST(CameraWatch, ForgetsTheViewsOfAnotherPart) {
  Walk walk;
  while (walk.view_count < 11) ASSERT_FALSE(walk.take_frame());
  walk.watch->begin_component();
  while (walk.view_count < 22 && !walk.is_over()) EXPECT_FALSE(walk.take_frame());
  EXPECT_FALSE(walk.watch->last_answer()) << "11 views and 11 are not 22";
}

}  // namespace
}  // namespace hermite::calibrate
