#include "core/calibrate/camera_watch.h"

#include <algorithm>
#include <array>
#include <future>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "core/adjust/feature_fields.h"
#include "core/base/step_back.h"
#include "core/calibrate/camera_check.h"
#include "core/calibrate/view_choice.h"
#include "core/dataset/camera_velocity.h"
#include "core/math/rigid3_fields.h"

namespace hermite::calibrate {
namespace {

// The numbers of views at which the camera is checked. Errors of 1 % of focal length and 1.5 % of
// bend are found at the first two (tests/accuracy/README.md, "A camera that is wrong"). A camera
// that is still unknown at the last one, which takes 24 times as much work, has another error.
constexpr std::array<std::size_t, 4> kAsksAt{12, 16, 24, 36};

// The verdict is due after this many frames: a second or two of a CPU that also tracks. A late
// verdict is waited for, so that the results depend on the frames alone.
constexpr int kFramesToAnswer = 20;

using SharedView = std::shared_future<CalibrationView>;

// A view that is being prepared, and the camera's velocity in it, which the next frame tells.
struct TimedView {
  SharedView prepared;
  std::optional<Vector6d> twist_per_s;

  CalibrationView get() const {
    CalibrationView view = prepared.get();
    view.known_twist_per_s = twist_per_s;
    return view;
  }
};

// The motion from one tracked frame to the next.
struct Step {
  double duration_s = 0;
  std::optional<Rigid3> last_from_camera;  // nullopt: unknown

  bool tells_velocity() const {
    return last_from_camera && duration_s > 0 && duration_s <= dataset::kMaxVelocityGap_s;
  }
};

// Returns the camera's velocity in the frame between two steps; nullopt if neither tells it.
std::optional<Vector6d> twist_per_s_between(const Step& before, const Step& after) {
  Rigid3 motion;
  double duration_s = 0;
  for (const Step* step : {&before, &after}) {
    if (!step->tells_velocity()) continue;
    motion = motion * *step->last_from_camera;
    duration_s += step->duration_s;
  }
  if (duration_s == 0) return std::nullopt;
  return log_se3(motion) / duration_s;
}

template <class Work>
auto on_a_thread_of_its_own(Work work) {
  return std::async(std::launch::async, [work = std::move(work)]() mutable {
    step_back();
    return work();
  });
}

template <class Bytes, class Value, class Fields>
void optional_fields(Bytes& bytes, std::optional<Value>& value, const Fields& fields) {
  bool is_there = value.has_value();
  bytes.flag(is_there);
  if (is_there && !value) value.emplace();
  if (value) fields(bytes, *value);
}

void step_fields(auto& bytes, Step& step) {
  bytes.number(step.duration_s);
  optional_fields(bytes, step.last_from_camera,
                  [](auto& to, Rigid3& motion) { rigid3_fields(to, motion); });
}

template <class Bytes, class Saved>
void view_fields(Bytes& bytes, Saved& view) {
  rigid3_fields(bytes, view.world_from_camera);
  optional_fields(bytes, view.known_twist_per_s,
                  [](auto& to, auto& twist_per_s) { to.numbers(twist_per_s.data(), 6); });
  bytes.number(view.patches.step_px);
  bytes.number(view.patches.nodes.width);
  bytes.number(view.patches.nodes.height);
  bytes.numbers(view.patches.nodes.pixels);
  bytes.list(view.features, [](auto& to, auto& feature) { adjust::feature_fields(to, feature); });
}

class Watch : public CameraWatch {
 public:
  explicit Watch(const Camera& camera)
      : straight_(rectified(camera)),
        lenses_(camera.color ? Lenses::kTwo : Lenses::kOne),
        grid_(patches_of(DepthImage(camera.width, camera.height), straight_)) {}

  void step(double timestamp_s, const std::optional<Rigid3>& last_from_camera) override {
    const Step step{timestamp_s - last_timestamp_s_, last_from_camera};
    if (new_view_.valid())
      add({std::exchange(new_view_, {}), twist_per_s_between(last_step_, step)});
    last_timestamp_s_ = timestamp_s;
    last_step_ = step;
  }

  bool wants(const Rigid3& world_from_camera) const override {
    return next_ask_ < kAsksAt.size() &&
           (views_.empty() || is_another_view(last_world_from_camera_, world_from_camera));
  }

  void view(frame::RgbdFrame frame, const Rigid3& world_from_camera) override {
    last_world_from_camera_ = world_from_camera;
    new_view_ = on_a_thread_of_its_own([this, frame = std::move(frame), world_from_camera] {
                  return CalibrationView{world_from_camera, patches_of(frame.depth, straight_),
                                         adjust::detect_features(frame, straight_)};
                }).share();
  }

  void begin_component() override {
    views_.clear();
    new_view_ = {};
  }

  std::optional<CameraCheck> answer() override {
    if (!answer_.valid() || --frames_to_answer_ > 0) return std::nullopt;
    return last_answer();
  }

  std::optional<CameraCheck> last_answer() override {
    if (!answer_.valid()) return std::nullopt;
    const CameraCheck check = answer_.get();
    asked_views_.clear();
    if (check.verdict != CameraVerdict::kUnknown) next_ask_ = kAsksAt.size();
    if (next_ask_ == kAsksAt.size()) views_.clear();
    return check;
  }

  void save(ByteWriter& bytes) const override {
    const auto list = [&bytes](const std::vector<TimedView>& views) {
      bytes.list(views, [](ByteWriter& to, const TimedView& view) {
        CalibrationView saved = view.get();
        view_fields(to, saved);
      });
    };
    list(views_);
    list(asked_views_);
    list(new_view_.valid() ? std::vector<TimedView>{{new_view_, {}}} : std::vector<TimedView>{});
    Step last_step = last_step_;
    step_fields(bytes, last_step);
    bytes.number(last_timestamp_s_);
    rigid3_fields(bytes, last_world_from_camera_);
    bytes.number(std::uint64_t{next_ask_});
    bytes.number(frames_to_answer_);
  }

  void restore(ByteReader& bytes) override {
    const auto list = [&bytes, this](std::vector<TimedView>& views) {
      std::vector<CalibrationView> read;
      bytes.list(read, [this](ByteReader& from, CalibrationView& view) {
        view_fields(from, view);
        const Image<DepthPatch>& nodes = view.patches.nodes;
        from.require(view.patches.step_px == grid_.step_px && nodes.width == grid_.nodes.width &&
                         nodes.height == grid_.nodes.height &&
                         nodes.pixels.size() == grid_.nodes.pixels.size(),
                     "the patches of a view have a wrong size");
      });
      bytes.require(read.size() <= kAsksAt.back() + kFramesToAnswer,
                    "there are too many views of the camera check");
      for (CalibrationView& view : read)
        views.push_back({std::async(std::launch::deferred, [view] { return view; }).share(),
                         view.known_twist_per_s});
    };
    std::vector<TimedView> new_views;
    list(views_);
    list(asked_views_);
    list(new_views);
    bytes.require(new_views.size() <= 1, "there is more than one new view");
    step_fields(bytes, last_step_);
    bytes.number(last_timestamp_s_);
    rigid3_fields(bytes, last_world_from_camera_);
    std::uint64_t next_ask = 0;
    bytes.number(next_ask);
    bytes.number(frames_to_answer_);
    bytes.require(next_ask <= kAsksAt.size() && frames_to_answer_ <= kFramesToAnswer,
                  "the schedule of the camera check is out of range");
    if (!bytes.ok()) return;
    next_ask_ = next_ask;
    if (!new_views.empty()) new_view_ = new_views[0].prepared;
    if (!asked_views_.empty()) ask(std::exchange(asked_views_, {}));
  }

 private:
  void add(TimedView view) {
    if (next_ask_ == kAsksAt.size()) return;
    views_.push_back(std::move(view));
    if (answer_.valid() || views_.size() < kAsksAt[next_ask_]) return;
    ask(views_);
    ++next_ask_;
    frames_to_answer_ = kFramesToAnswer;
  }

  void ask(std::vector<TimedView> about) {
    asked_views_ = std::move(about);
    answer_ = on_a_thread_of_its_own([this, about = asked_views_] {
      std::vector<CalibrationView> views;
      for (const TimedView& view : about) views.push_back(view.get());
      return check_camera(views, straight_, lenses_);
    });
  }

  const Camera straight_;
  const Lenses lenses_;
  const PatchGrid grid_;  // without depth; used to check sizes
  std::vector<TimedView> views_, asked_views_;
  SharedView new_view_;  // of the last tracked frame
  Step last_step_;       // to the last tracked frame
  double last_timestamp_s_ = 0;
  Rigid3 last_world_from_camera_;
  std::size_t next_ask_ = 0;
  int frames_to_answer_ = 0;
  // Last: its destructor waits for tasks that use the other members.
  std::future<CameraCheck> answer_;
};

}  // namespace

std::unique_ptr<CameraWatch> make_camera_watch(const Camera& camera) {
  return std::make_unique<Watch>(camera);
}

}  // namespace hermite::calibrate
