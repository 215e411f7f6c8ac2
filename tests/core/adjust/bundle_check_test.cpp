#include "core/adjust/bundle_check.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "tests/core/adjust/bundle_world.h"

namespace hermite::adjust {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInfinity = std::numeric_limits<double>::infinity();

BundleProblem good_problem() {
  BundleProblem problem = test::make_world({}).truth;
  problem.links.push_back({0, 1, Rigid3(), test::information_of(0.01, 0.01), true});
  return problem;
}

// The message of the error after that change, empty when there is none.
std::string message_after(const std::function<void(BundleProblem&)>& change) {
  BundleProblem problem = good_problem();
  change(problem);
  const Status status = validate(problem, {});
  if (status.ok()) return "";
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
  return status.error().message;
}

TEST(BundleCheck, TakesWhatIsGood) {
  EXPECT_EQ(message_after([](BundleProblem&) {}), "");
  EXPECT_TRUE(validate(BundleProblem{}, {}).ok());
  // Neither all information, nor a camera where nothing is observed.
  EXPECT_EQ(message_after([](BundleProblem& p) { p.links[0].information.setZero(); }), "");
  EXPECT_EQ(message_after([](BundleProblem& p) { p.observations.clear(), p.camera = Camera(); }),
            "");
}

TEST(BundleCheck, NamesTheFieldThatIsWrong) {
  struct Case {
    std::string message;
    std::function<void(BundleProblem&)> change;
  };
  const Case cases[] = {
      {"is_fixed has 9 entries for 10", [](BundleProblem& p) { p.is_fixed.pop_back(); }},
      {"world_from_submap[3] is not finite",
       [](BundleProblem& p) { p.world_from_submap[3].translation.x() = kNan; }},
      {"world_from_submap[3] is not finite",
       [](BundleProblem& p) { p.world_from_submap[3].rotation.w() = kInfinity; }},
      {"world_from_submap[3] is not a rotation",
       [](BundleProblem& p) { p.world_from_submap[3].rotation.coeffs() *= 1.01; }},
      {"world_from_submap[3] lies more than",
       [](BundleProblem& p) { p.world_from_submap[3].translation.y() = -1e7; }},
      {"keyframes[7].submap is 10", [](BundleProblem& p) { p.keyframes[7].submap = 10; }},
      {"keyframes[7].submap_from_camera is",
       [](BundleProblem& p) { p.keyframes[7].submap_from_camera.rotation.coeffs().setZero(); }},
      {"keyframes[7].weight is", [](BundleProblem& p) { p.keyframes[7].weight = 0; }},
      {"keyframes[7].weight is", [](BundleProblem& p) { p.keyframes[7].weight = 1.5; }},
      {"keyframes[7].weight is", [](BundleProblem& p) { p.keyframes[7].weight = kNan; }},
      {"landmarks_in_world[5]", [](BundleProblem& p) { p.landmarks_in_world[5].z() = kNan; }},
      {"landmarks_in_world[5]", [](BundleProblem& p) { p.landmarks_in_world[5].x() = 1e9; }},
      {"camera.fx", [](BundleProblem& p) { p.camera.fx = 0; }},
      {"observations[2].keyframe is 40", [](BundleProblem& p) { p.observations[2].keyframe = 40; }},
      {"observations[2].landmark is 400",
       [](BundleProblem& p) { p.observations[2].landmark = 400; }},
      {"observations[2].pixel_px", [](BundleProblem& p) { p.observations[2].pixel_px.y() = kNan; }},
      {"observations[2].pixel_px", [](BundleProblem& p) { p.observations[2].pixel_px.x() = -1e9; }},
      {"observations[2].depth_m", [](BundleProblem& p) { p.observations[2].depth_m = kNan; }},
      {"observations[2].depth_m", [](BundleProblem& p) { p.observations[2].depth_m = -1; }},
      {"observations[2].scale", [](BundleProblem& p) { p.observations[2].scale = 0; }},
      {"observations[2].scale", [](BundleProblem& p) { p.observations[2].scale = kNan; }},
      {"links[0] joins submaps 0 and 99", [](BundleProblem& p) { p.links[0].to = 99; }},
      {"links[0] joins submap 1 with itself", [](BundleProblem& p) { p.links[0].from = 1; }},
      {"links[0].from_from_to is not finite",
       [](BundleProblem& p) { p.links[0].from_from_to.translation.z() = kInfinity; }},
      {"links[0].information is not finite",
       [](BundleProblem& p) { p.links[0].information(2, 2) = kNan; }},
      {"links[0].information is above", [](BundleProblem& p) { p.links[0].information *= 1e18; }},
      {"links[0].information is not symmetric",
       [](BundleProblem& p) { p.links[0].information(0, 5) = 1; }},
      {"links[0].information is not positive",
       [](BundleProblem& p) { p.links[0].information(4, 4) = -1; }},
  };
  for (const Case& c : cases) {
    const std::string message = message_after(c.change);
    EXPECT_NE(message.find(c.message), std::string::npos)
        << "\"" << message << "\" has no \"" << c.message << "\"";
  }
}

TEST(BundleCheck, BoundsTheOptions) {
  EXPECT_FALSE(validate({}, {-1, 10, 1e-6}).ok());
  EXPECT_FALSE(validate({}, {5, 1'000'000, 1e-6}).ok());
  EXPECT_FALSE(validate({}, {5, 10, kNan}).ok());
  EXPECT_TRUE(validate({}, {0, 0, 0}).ok());
}

// Submaps 0 - 1 by a link, 2 - 3 by landmark 0, 3 - 1 by landmark 1; 4 alone. Only 0 is fixed.
TEST(TiedToFixed, FollowsLinksAndSharedLandmarks) {
  BundleProblem problem;
  problem.world_from_submap.resize(5);
  problem.is_fixed = {true, false, false, false, false};
  for (std::uint32_t i = 0; i < 5; ++i) problem.keyframes.push_back({i, Rigid3()});
  problem.landmarks_in_world.resize(3);
  problem.links.push_back({1, 0, Rigid3(), Matrix6d::Identity(), false});
  const auto see = [&](std::uint32_t keyframe, std::uint32_t landmark) {
    problem.observations.push_back({keyframe, landmark, Eigen::Vector2d::Zero(), 1, 1});
  };
  see(2, 0), see(3, 0), see(3, 1), see(1, 1), see(4, 2);
  EXPECT_EQ(tied_to_fixed(problem, {true, true, true, true, true}),
            std::vector<bool>({true, true, true, true, false}));
  EXPECT_EQ(tied_to_fixed(problem, {true, true, true, false, true}),
            std::vector<bool>({true, true, false, false, false}));
  problem.is_fixed = {false, false, false, false, true};
  EXPECT_EQ(tied_to_fixed(problem, {true, true, true, true, true}),
            std::vector<bool>({false, false, false, false, true}));
}

}  // namespace
}  // namespace hermite::adjust
