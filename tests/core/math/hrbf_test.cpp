#include "core/math/hrbf.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

namespace hermite {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kFocal_px = 528;  // of the measurements that the oracles below come from

// A point and the unit normal away from the camera where the ray (x, y, 1) meets a surface.
struct Hit {
  Vector3d position_m, normal;
};
using Surface = std::function<Hit(const Vector3d& ray)>;

Surface plane(double depth_m, double tilt_rad) {
  const Vector3d n(std::sin(tilt_rad), 0, std::cos(tilt_rad));
  return [=](const Vector3d& ray) { return Hit{n.z() * depth_m / n.dot(ray) * ray, n}; };
}

// Convex towards the camera: its nearest point is at depth_m on the optical axis.
Surface sphere(double depth_m, double radius_m) {
  const Vector3d centre(0, 0, depth_m + radius_m);
  return [=](const Vector3d& ray) {
    const Vector3d d = ray.normalized();
    const double along = d.dot(centre);
    const Vector3d hit =
        (along - std::sqrt(along * along - centre.squaredNorm() + radius_m * radius_m)) * d;
    return Hit{hit, (centre - hit) / radius_m};
  };
}

// Concave, as seen from inside.
Surface bowl(double depth_m, double radius_m) {
  const Vector3d centre(0, 0, depth_m - radius_m);
  return [=](const Vector3d& ray) {
    const Vector3d d = ray.normalized();
    const double along = d.dot(centre);
    const Vector3d hit =
        (along + std::sqrt(along * along - centre.squaredNorm() + radius_m * radius_m)) * d;
    return Hit{hit, (hit - centre) / radius_m};
  };
}

Vector3d pixel_ray(double u, double v) { return {u / kFocal_px, v / kFocal_px, 1}; }

// Kernels of a window of pixels around the optical axis, with the support radius of the frame maps:
// 4 sqrt(2) z / f, up to twice that when tilted.
std::vector<HrbfKernel> window(const Surface& surface, int half_width = 3) {
  std::vector<HrbfKernel> kernels;
  for (int v = -half_width; v <= half_width; ++v)
    for (int u = -half_width; u <= half_width; ++u) {
      const Hit hit = surface(pixel_ray(u, v));
      const double diagonal_m = std::sqrt(2.0) * hit.position_m.z() / kFocal_px;
      kernels.push_back(
          {hit.position_m, hit.normal, 4 * std::min(2 * diagonal_m, diagonal_m / hit.normal.z())});
    }
  return kernels;
}

std::vector<HrbfKernel> random_kernels(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> spread(-0.02, 0.02), radius(0.015, 0.03);
  std::vector<HrbfKernel> kernels;
  for (int i = 0; i < 40; ++i)
    kernels.push_back({{spread(random), spread(random), 1 + 0.3 * spread(random)},
                       Vector3d(10 * spread(random), 10 * spread(random), 1).normalized(),
                       radius(random)});
  return kernels;
}

double degrees(double value) { return value * M_PI / 180; }

TEST(EvaluateHrbf, DerivativesAgreeWithFiniteDifferences) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> spread(-0.01, 0.01);
  constexpr double kStep_m = 1e-7;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<HrbfKernel> kernels = random_kernels(seed);
    const Vector3d x(spread(random), spread(random), 1 + 0.3 * spread(random));
    const HrbfSample sample = evaluate_hrbf(kernels, x);
    Vector3d gradient;
    Matrix3d hessian;
    for (int axis = 0; axis < 3; ++axis) {
      const HrbfSample ahead = evaluate_hrbf(kernels, x + kStep_m * Vector3d::Unit(axis));
      const HrbfSample behind = evaluate_hrbf(kernels, x - kStep_m * Vector3d::Unit(axis));
      gradient[axis] = (ahead.value - behind.value) / (2 * kStep_m);
      hessian.col(axis) = (ahead.gradient - behind.gradient) / (2 * kStep_m);
    }
    EXPECT_LT((sample.gradient - gradient).norm(), 1e-6 * gradient.norm()) << seed;
    EXPECT_LT((sample.hessian - hessian).norm(), 1e-6 * hessian.norm()) << seed;
    EXPECT_LT((sample.hessian - sample.hessian.transpose()).norm(), 1e-12 * sample.hessian.norm());
  }
}

TEST(EvaluateHrbf, IsNegativeInFrontAndPositiveBehind) {
  const std::vector<HrbfKernel> kernels = window(plane(1, degrees(30)));
  EXPECT_LT(evaluate_hrbf(kernels, {0, 0, 0.997}).value, 0);
  EXPECT_GT(evaluate_hrbf(kernels, {0, 0, 1.003}).value, 0);
}

TEST(EvaluateHrbf, OutsideAllSupportsThereIsNothing) {
  const HrbfSample sample = evaluate_hrbf(window(plane(1, 0)), {0, 0, 1.5});
  EXPECT_EQ(sample.support_count, 0);
  EXPECT_EQ(sample.value, 0);
  EXPECT_EQ(sample.gradient, Vector3d::Zero());
  EXPECT_EQ(evaluate_hrbf({}, {0, 0, 1}).support_count, 0);
}

TEST(EvaluateHrbf, AtItsOwnCentreAKernelHasAGradientOnly) {
  const HrbfKernel kernel{{0, 0, 1}, {0, 0, 1}, 0.01};
  const HrbfSample sample = evaluate_hrbf({&kernel, 1}, kernel.position_m);
  EXPECT_EQ(sample.value, 0);
  EXPECT_NEAR(sample.gradient.z(), 200 / 1e-4, 1e-6);
  EXPECT_EQ(sample.hessian, Matrix3d::Zero());
}

// Gradient magnitude G and confidence of planes under a full 7x7 window: measured once with an
// independent program.
TEST(HrbfConfidence, TableOfPlanes) {
  struct Row {
    double depth_m, tilt_deg, radius_mm, gradient, confidence;
  };
  for (const Row& row : {Row{0.5, 0, 5.36, 6.839e7, 0.886}, Row{1.0, 0, 10.71, 1.710e7, 0.785},
                         Row{1.0, 60, 21.43, 6.50e6, 0.676}, Row{2.0, 0, 21.43, 4.275e6, 0.617},
                         Row{3.0, 0, 32.14, 1.900e6, 0.484}, Row{3.5, 60, 75.0, 5.31e5, 0.253}}) {
    const std::vector<HrbfKernel> kernels = window(plane(row.depth_m, degrees(row.tilt_deg)));
    const HrbfKernel& centre = kernels[24];
    const HrbfSample sample = evaluate_hrbf(kernels, centre.position_m);
    EXPECT_NEAR(1000 * centre.radius_m, row.radius_mm, 0.01)
        << row.depth_m << " m, " << row.tilt_deg << " deg";
    // The table has three to four digits.
    EXPECT_NEAR(sample.gradient.dot(centre.normal), row.gradient, 2e-3 * row.gradient)
        << row.depth_m << " m, " << row.tilt_deg << " deg";
    EXPECT_NEAR(hrbf_confidence(sample.gradient, centre.normal), row.confidence, 1e-3)
        << row.depth_m << " m, " << row.tilt_deg << " deg";
  }
}

TEST(HrbfConfidence, OfAFullFrontalWindowFallsWithTheRadius) {
  for (double depth_m : {0.4, 0.8, 1.6, 3.2}) {
    const std::vector<HrbfKernel> kernels = window(plane(depth_m, 0));
    const double confidence =
        hrbf_confidence(evaluate_hrbf(kernels, kernels[24].position_m).gradient, Vector3d::UnitZ());
    EXPECT_NEAR(confidence, std::exp(-22.6 * kernels[24].radius_m), 2e-3);
  }
}

TEST(HrbfConfidence, IsZeroWhereNothingSupports) {
  EXPECT_EQ(hrbf_confidence(Vector3d::Zero(), Vector3d::UnitZ()), 0);
}

TEST(PrincipalCurvatures, OfAnImplicitSphereAndCylinderAreExactWithSign) {
  // f = R - |x - c| at the point nearest to the camera: gradient away from it, Hessian -(I - n n^T)
  // / R.
  const double radius_m = 0.25, scale = 1e6;  // of f: must not matter
  const Vector3d n = Vector3d(0.2, -0.1, 1).normalized();
  const Matrix3d across = Matrix3d::Identity() - n * n.transpose();
  const auto convex = principal_curvatures(scale * n, -scale / radius_m * across);
  ASSERT_TRUE(convex);
  EXPECT_NEAR(convex->max_per_m, 4, 1e-6);
  EXPECT_NEAR(convex->min_per_m, 4, 1e-6);
  const auto concave = principal_curvatures(scale * n, scale / radius_m * across);
  EXPECT_NEAR(concave->max_per_m, -4, 1e-6);
  EXPECT_NEAR(concave->min_per_m, -4, 1e-6);
  const Vector3d axis = n.unitOrthogonal();
  const auto cylinder =
      principal_curvatures(scale * n, -scale / radius_m * (across - axis * axis.transpose()));
  EXPECT_NEAR(cylinder->max_per_m, 4, 1e-9);
  EXPECT_NEAR(cylinder->min_per_m, 0, 1e-9);
  const auto saddle =
      principal_curvatures(scale * n, scale / radius_m * (2 * axis * axis.transpose() - across));
  EXPECT_NEAR(saddle->max_per_m, 4, 1e-9);
  EXPECT_NEAR(saddle->min_per_m, -4, 1e-9);
}

TEST(PrincipalCurvatures, AreNothingWithoutAGradient) {
  EXPECT_FALSE(principal_curvatures(Vector3d::Zero(), Matrix3d::Identity()));
  EXPECT_FALSE(principal_curvatures(Vector3d(NAN, 0, 1), Matrix3d::Identity()));
}

TEST(PrincipalCurvatures, OfAPlaneAreZeroHoweverItIsTiltedAndSampled) {
  for (double tilt_deg : {0.0, 20.0, 60.0, 75.0}) {
    std::vector<HrbfKernel> kernels = window(plane(1.3, degrees(tilt_deg)));
    for (int dropped = 0; dropped < 2; ++dropped) {
      const HrbfSample sample =
          evaluate_hrbf(kernels, plane(1.3, degrees(tilt_deg))(pixel_ray(0.3, -0.2)).position_m);
      const auto curvatures = principal_curvatures(sample.gradient, sample.hessian);
      ASSERT_TRUE(curvatures);
      // K is a difference of products: its root loses half of the digits.
      EXPECT_NEAR(curvatures->max_per_m, 0, 1e-5);
      EXPECT_NEAR(curvatures->min_per_m, 0, 1e-5);
      kernels.erase(kernels.begin(), kernels.begin() + 15);  // now an asymmetric window
    }
  }
}

// R times the estimated mean curvature of a sphere 1 m away.
double sphere_ratio(const std::vector<HrbfKernel>& kernels, const Vector3d& point_m,
                    double radius_m, std::optional<std::size_t> own = {}) {
  const HrbfSample sample = evaluate_hrbf(kernels, point_m, own);
  const auto curvatures = principal_curvatures(sample.gradient, sample.hessian);
  return curvatures ? 0.5 * (curvatures->max_per_m + curvatures->min_per_m) * radius_m : NAN;
}

TEST(PrincipalCurvatures, OfASphereAreOverestimatedByAKnownFactor) {
  for (double radius_m : {0.03, 0.1, 0.3}) {
    const Surface surface = sphere(1, radius_m);
    const std::vector<HrbfKernel> tile = window(surface, 3), whole = window(surface, 6);
    EXPECT_NEAR(sphere_ratio(tile, tile[24].position_m, radius_m), 1.295, 0.005)
        << "7x7 at a kernel's centre";
    const Vector3d between = pixel_ray(0.5, 0.5);
    EXPECT_NEAR(sphere_ratio(tile, intersect_hrbf(tile, between)->point_m, radius_m), 1.25, 0.02)
        << "7x7 on the zero set, between kernels";
    EXPECT_NEAR(sphere_ratio(whole, intersect_hrbf(whole, between)->point_m, radius_m), 1.09, 0.04)
        << "the same with the whole support";
  }
}

TEST(PrincipalCurvatures, NeedTheOwnKernelLeftOutOnceItsVertexMoved) {
  const double radius_m = 0.3;
  const std::vector<HrbfKernel> kernels = window(sphere(1, radius_m));
  const Vector3d moved = intersect_hrbf(kernels, {0, 0, 1})->point_m;
  EXPECT_GT((moved - kernels[24].position_m).norm(), 1e-5);
  EXPECT_NEAR(sphere_ratio(kernels, moved, radius_m, 24), 1.346, 0.005);
  EXPECT_LT(sphere_ratio(kernels, moved, radius_m), 0)
      << "not even the sign survives, which is why there is `own`";
}

TEST(PrincipalCurvatures, OfABowlAreNegative) {
  const std::vector<HrbfKernel> kernels = window(bowl(1, 0.3));
  const HrbfSample sample = evaluate_hrbf(kernels, kernels[24].position_m);
  const auto curvatures = principal_curvatures(sample.gradient, sample.hessian);
  ASSERT_TRUE(curvatures);
  EXPECT_LT(curvatures->max_per_m, -1 / 0.3);
  EXPECT_GT(curvatures->min_per_m, -1.5 / 0.3);
}

TEST(IntersectHrbf, APlaneIsMetExactly) {
  for (double tilt_deg : {0.0, 30.0, 60.0}) {
    const Surface surface = plane(1.7, degrees(tilt_deg));
    for (bool correct_bias : {false, true}) {
      const Vector3d ray = pixel_ray(0.4, -0.3);
      const auto hit = intersect_hrbf(window(surface), ray, {.correct_bias = correct_bias});
      ASSERT_TRUE(hit);
      EXPECT_LT((hit->point_m - surface(ray).position_m).norm(), 1e-12);
      EXPECT_LT((hit->normal - surface(ray).normal).norm(), 1e-12);
      EXPECT_LE(hit->evaluation_count, correct_bias ? 4 : 3);
    }
  }
}

TEST(IntersectHrbf, TheRootIsARootOfTheImplicit) {
  int hit_count = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<HrbfKernel> kernels = random_kernels(seed);
    const auto hit = intersect_hrbf(kernels, {0.001, -0.002, 1},
                                    {.max_evaluation_count = 100, .tolerance_m = 1e-12});
    if (!hit) continue;
    ++hit_count;
    const HrbfSample sample = evaluate_hrbf(kernels, hit->point_m);
    EXPECT_LT(std::abs(sample.value), 1e-9 * sample.gradient.norm()) << seed;
    EXPECT_LT((sample.gradient.normalized() - hit->normal).norm(), 1e-12);
  }
  EXPECT_GE(hit_count, 15) << "even random kernels mostly have a surface";
}

TEST(IntersectHrbf, TheLengthOfTheRayDoesNotMatter) {
  const std::vector<HrbfKernel> kernels = window(sphere(1, 0.1));
  const Vector3d ray = pixel_ray(0.5, 0.5);
  const auto by_depth = intersect_hrbf(kernels, ray),
             by_distance = intersect_hrbf(kernels, ray.normalized());
  ASSERT_TRUE(by_depth && by_distance);
  EXPECT_LT((by_depth->point_m - by_distance->point_m).norm(), 1e-9);
  EXPECT_NEAR(by_depth->ray_parameter, by_depth->point_m.z(), 1e-12);
}

TEST(IntersectHrbf, ASphereIsMetOutsideByAKnownOffsetThatTheCorrectionRemoves) {
  struct Case {
    int half_width;
    double factor;  // of r^2 / R
  };
  for (const auto& [half_width, factor] : {Case{3, 0.063}, Case{6, 0.072}})
    for (double radius_m : {0.03, 0.1, 0.3}) {
      const std::vector<HrbfKernel> kernels = window(sphere(1, radius_m), half_width);
      const double support_m = kernels[kernels.size() / 2].radius_m,
                   expected_m = factor * support_m * support_m / radius_m;
      const auto hit = intersect_hrbf(kernels, {0, 0, 1});
      ASSERT_TRUE(hit);
      EXPECT_NEAR(1 - hit->ray_parameter, expected_m, 0.05 * expected_m)
          << "towards the camera, R = " << radius_m;
      EXPECT_LE(hit->evaluation_count, 6);
      const auto corrected = intersect_hrbf(kernels, {0, 0, 1}, {.correct_bias = true});
      ASSERT_TRUE(corrected);
      EXPECT_NEAR(corrected->ray_parameter, 1, 3e-6) << "R = " << radius_m;
    }
}

TEST(IntersectHrbf, NeedsEnoughSupportAtTheSolution) {
  const std::vector<HrbfKernel> full = window(plane(1, 0));
  const std::vector<HrbfKernel> six(full.begin() + 22, full.begin() + 28),
      seven(full.begin() + 21, full.begin() + 28);
  EXPECT_TRUE(intersect_hrbf(seven, {0, 0, 1}));
  EXPECT_FALSE(intersect_hrbf(six, {0, 0, 1}));
  EXPECT_TRUE(intersect_hrbf(six, {0, 0, 1}, {.min_support_count = 6}));
}

TEST(IntersectHrbf, MissesWhatIsNotThere) {
  const std::vector<HrbfKernel> kernels = window(plane(1, 0));
  EXPECT_FALSE(intersect_hrbf({}, {0, 0, 1}));
  EXPECT_FALSE(intersect_hrbf(kernels, {0.5, 0, 1})) << "passes beside all supports";
  std::vector<HrbfKernel> back = kernels;
  for (HrbfKernel& kernel : back) kernel.normal = -kernel.normal;
  EXPECT_FALSE(intersect_hrbf(back, {0, 0, 1})) << "a back side";
  EXPECT_FALSE(intersect_hrbf(kernels, {0, 0, -1})) << "behind the origin";
}

}  // namespace
}  // namespace hermite
