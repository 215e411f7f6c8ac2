#include "core/mesh/surfel_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/core/mesh/mesh_shapes.h"

namespace hermite::mesh {
namespace {

using testing::HasSubstr;

SurfelField field_of(const output::Cloud& cloud, double cell_m = 0.01) {
  FieldOptions options;
  options.cell_m = cell_m;
  Result<SurfelField> field = SurfelField::create(cloud, options);
  EXPECT_TRUE(field.ok());
  return *std::move(field);
}

FieldSample sample(const SurfelField& field, const Eigen::Vector3f& point_m) {
  const Eigen::Vector3i cell =
      (point_m.cast<double>() / field.cell_m()).array().floor().cast<int>();
  FieldWindow window(field, cell, cell + Eigen::Vector3i::Ones());
  return window.sample(point_m);
}

TEST(SurfelField, IsTheSignedDistanceToAPlane) {
  output::Cloud cloud;
  append_square(cloud, 0.4f, 0.01f);
  const SurfelField field = field_of(cloud);
  for (const float z_m : {-0.01f, 0.0f, 0.004f, 0.015f}) {
    const FieldSample at = sample(field, {0.003f, -0.002f, z_m});
    EXPECT_NEAR(at.value_m, z_m, 1e-6f);
    EXPECT_TRUE(at.normal.isApprox(Eigen::Vector3f::UnitZ(), 1e-5f));
    EXPECT_NEAR(at.color.x(), 200, 0.1f);
  }
  EXPECT_EQ(sample(field, {0, 0, 0.2f}).kernel_count, 0);
}

TEST(SurfelField, TellsWithinFromBorderFromBeyond) {
  output::Cloud cloud;
  append_square(cloud, 0.4f, 0.01f);
  const SurfelField field = field_of(cloud);
  const FieldSample within = sample(field, {0.001f, 0.002f, 0}),
                    border = sample(field, {0.2f, 0, 0}), beyond = sample(field, {0.215f, 0, 0});
  EXPECT_NEAR(within.coverage, 1, 0.25f);
  EXPECT_LT(within.lean, 0.05f);
  EXPECT_GT(border.lean, 2 * within.lean + 0.05f);
  EXPECT_GT(beyond.lean, 0.3f);
  EXPECT_LT(beyond.coverage, border.coverage);
}

// The zero set of the plain field lies outside of what is curved: by 0.07 r^2 / R, a fifth of a
// millimetre here.
TEST(SurfelField, HasNoBiasOnASphere) {
  const float radius_m = 0.2f;
  const SurfelField field = field_of(sphere(radius_m, 5000));
  double worst_m = 0;
  for (const output::CloudPoint& point : sphere(radius_m, 77))
    worst_m =
        std::max(worst_m, std::abs(static_cast<double>(sample(field, point.position_m).value_m)));
  EXPECT_LT(worst_m, 5e-5);
}

TEST(SurfelField, TwoLayersOfOneSurfaceAreOneSheetBetweenThem) {
  output::Cloud cloud;
  append_square(cloud, 0.3f, 0.01f, 0.0f);
  append_square(cloud, 0.3f, 0.01f, 0.006f);
  const SurfelField field = field_of(cloud);
  float before = sample(field, {0, 0, -0.012f}).value_m;
  int sign_changes = 0;
  for (float z_m = -0.011f; z_m < 0.018f; z_m += 0.001f) {
    const float value_m = sample(field, {0, 0, z_m}).value_m;
    sign_changes += (before < 0) != (value_m < 0) ? 1 : 0;
    before = value_m;
  }
  EXPECT_EQ(sign_changes, 1);
  EXPECT_NEAR(sample(field, {0, 0, 0.003f}).value_m, 0, 5e-4f);
}

TEST(SurfelField, AnswersAlikeFromEveryWindow) {
  const SurfelField field = field_of(sphere(0.2f, 3000));
  FieldWindow small(field, {18, 0, 0}, {20, 1, 1}), large(field, {-30, -30, -30}, {30, 30, 30});
  const Eigen::Vector3f point_m(0.1987f, 0.0031f, 0.0022f);
  const FieldSample one = small.sample(point_m), other = large.sample(point_m);
  EXPECT_GT(one.kernel_count, 10);
  EXPECT_EQ(one.kernel_count, other.kernel_count);
  EXPECT_EQ(one.value_m, other.value_m);
  EXPECT_EQ(one.normal, other.normal);
}

TEST(SurfelField, ChoosesACellByTheDistanceOfPoints) {
  output::Cloud fine, coarse, tiny;
  append_square(fine, 0.3f, 0.012f);
  append_square(coarse, 3, 0.1f);
  append_square(tiny, 0.03f, 0.001f);
  EXPECT_NEAR(field_of(fine, 0).cell_m(), 0.012, 0.003);
  EXPECT_EQ(field_of(coarse, 0).cell_m(), 0.04);
  EXPECT_EQ(field_of(tiny, 0).cell_m(), 0.005);
}

TEST(SurfelField, LeavesOutWhatIsNoSurfel) {
  output::Cloud cloud;
  append_square(cloud, 0.1f, 0.01f);
  const std::size_t good = cloud.size();
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  cloud.push_back(surfel_at({nan, 0, 0}, Eigen::Vector3f::UnitZ()));
  cloud.push_back(surfel_at({0, infinite, 0}, Eigen::Vector3f::UnitZ()));
  cloud.push_back(surfel_at({0, 0, 0}, Eigen::Vector3f::Zero()));
  cloud.push_back(surfel_at({0, 0, 0}, {nan, 0, 1}));
  cloud.push_back(surfel_at({0, 0, 0}, Eigen::Vector3f::UnitZ()));
  cloud.back().confidence = nan;
  const SurfelField field = field_of(cloud);
  EXPECT_EQ(field.kernels().size(), good);
  EXPECT_EQ(field.rejected_count(), 5u);
}

TEST(SurfelField, TakesPointsWithoutConfidenceAlike) {
  output::Cloud cloud;
  append_square(cloud, 0.1f, 0.01f);
  for (output::CloudPoint& point : cloud) point.confidence = 0;
  EXPECT_NEAR(sample(field_of(cloud), {0, 0, 0.003f}).value_m, 0.003f, 1e-6f);
}

TEST(SurfelField, RefusesWithAMessage) {
  EXPECT_THAT(SurfelField::create({}, {}).error().message, HasSubstr("no point"));
  output::Cloud cloud;
  append_square(cloud, 0.1f, 0.01f);
  FieldOptions options;
  options.cell_m = 0.5;
  EXPECT_THAT(SurfelField::create(cloud, options).error().message, HasSubstr("cell"));
  cloud.push_back(surfel_at({1e9f, 0, 0}, Eigen::Vector3f::UnitZ()));
  EXPECT_THAT(SurfelField::create(cloud, {}).error().message, HasSubstr("too far"));
}

TEST(SurfelField, IsThereForOnePoint) {
  const SurfelField field = field_of({surfel_at({0, 0, 0}, Eigen::Vector3f::UnitZ())}, 0);
  EXPECT_EQ(sample(field, {0, 0, 0.002f}).kernel_count, 1);
}

}  // namespace
}  // namespace hermite::mesh
