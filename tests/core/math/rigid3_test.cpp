#include "core/math/rigid3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hermite {
namespace {

Vector6d random_twist(std::mt19937& random, double largest_angle_rad) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = uniform(random);
  twist.tail<3>() *= largest_angle_rad / std::sqrt(3.0);
  return twist;
}

Rigid3 random_transform(std::mt19937& random) { return exp_se3(random_twist(random, 3.0)); }

double difference(const Rigid3& a, const Rigid3& b) { return (a.matrix() - b.matrix()).norm(); }

// The exponential by its defining series: an independent truth.
Eigen::Matrix4d exp_by_series(const Vector6d& twist) {
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topRightCorner<3, 1>() = twist.head<3>();
  generator(0, 1) = -twist[5];
  generator(0, 2) = twist[4];
  generator(1, 0) = twist[5];
  generator(1, 2) = -twist[3];
  generator(2, 0) = -twist[4];
  generator(2, 1) = twist[3];
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = sum;
  for (int i = 1; i < 60; ++i) {
    term = term * generator / i;
    sum += term;
  }
  return sum;
}

TEST(Rigid3, ComposesAndMapsLikeMatrices) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 a_from_b = random_transform(random), b_from_c = random_transform(random);
    EXPECT_LT(((a_from_b * b_from_c).matrix() - a_from_b.matrix() * b_from_c.matrix()).norm(),
              1e-12);
    const Eigen::Vector3d p = random_twist(random, 1).head<3>();
    EXPECT_LT((a_from_b * p - (a_from_b.matrix() * p.homogeneous()).head<3>()).norm(), 1e-12);
    EXPECT_LT((a_from_b * (b_from_c * p) - (a_from_b * b_from_c) * p).norm(), 1e-12);
  }
}

TEST(Rigid3, InverseUndoes) {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 t = random_transform(random);
    EXPECT_LT(difference(t * inverse(t), Rigid3()), 1e-12);
    EXPECT_LT(difference(inverse(t) * t, Rigid3()), 1e-12);
    EXPECT_LT((inverse(t).matrix() - t.matrix().inverse()).norm(), 1e-12);
  }
}

TEST(Rigid3, LongProductsStayRigid) {
  std::mt19937 random(3);
  const Rigid3 step = exp_se3(random_twist(random, 0.01));
  Rigid3 pose;
  for (int i = 0; i < 100'000; ++i) pose = pose * step;
  EXPECT_NEAR(pose.rotation.norm(), 1, 1e-14);
}

TEST(ExpSe3, AgreesWithTheSeries) {
  std::mt19937 random(4);
  for (double angle : {0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.1, 1.0, 3.0})
    for (int i = 0; i < 20; ++i) {
      const Vector6d twist = random_twist(random, angle);
      EXPECT_LT((exp_se3(twist).matrix() - exp_by_series(twist)).norm(), 1e-12)
          << "angle up to " << angle;
    }
}

TEST(LogSe3, InvertsTheExponential) {
  std::mt19937 random(5);
  for (double angle : {0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.1, 1.0, 3.0})
    for (int i = 0; i < 20; ++i) {
      const Vector6d twist = random_twist(random, angle);
      EXPECT_LT((log_se3(exp_se3(twist)) - twist).norm(), 1e-10) << "angle up to " << angle;
    }
}

TEST(LogSe3, TakesTheShorterWayRound) {
  Rigid3 t = exp_se3((Vector6d() << 0, 0, 0, 0, 0, 3.0).finished());
  t.rotation.coeffs() *= -1;  // the same rotation
  EXPECT_NEAR(log_se3(t)[5], 3.0, 1e-12);
  EXPECT_NEAR(angle_rad(t.rotation), 3.0, 1e-12);
  const Rigid3 beyond = exp_se3((Vector6d() << 0, 0, 0, 0, 0, 4.0).finished());
  EXPECT_NEAR(log_se3(beyond)[5], 4.0 - 2 * M_PI, 1e-12);
}

TEST(LogSe3, HalfATurnComesBack) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0.6, 0, 0.8)}) {
    const Rigid3 t{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, axis)), {1, 2, 3}};
    EXPECT_LT(difference(exp_se3(log_se3(t)), t), 1e-10);
    EXPECT_NEAR(angle_rad(t.rotation), M_PI, 1e-10);
  }
}

TEST(Rigid3FromMatrix, InvertsMatrixAndMendsRounding) {
  std::mt19937 random(6);
  for (int i = 0; i < 50; ++i) {
    const Rigid3 t = random_transform(random);
    EXPECT_LT(difference(rigid3_from_matrix(t.matrix()), t), 1e-12);
    Eigen::Matrix4d rounded = t.matrix();
    rounded.topLeftCorner<3, 3>() += 1e-4 * Eigen::Matrix3d::Random();
    const Rigid3 mended = rigid3_from_matrix(rounded);
    EXPECT_NEAR(mended.rotation.norm(), 1, 1e-14);
    EXPECT_LT(difference(mended, t), 1e-3);
  }
}

TEST(IsFinite, SeesEveryBadNumber) {
  EXPECT_TRUE(is_finite(Rigid3()));
  for (double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 4; ++i) {
      Rigid3 t;
      t.rotation.coeffs()[i] = bad;
      EXPECT_FALSE(is_finite(t));
    }
    for (int i = 0; i < 3; ++i) {
      Rigid3 t;
      t.translation[i] = bad;
      EXPECT_FALSE(is_finite(t));
    }
  }
}

}  // namespace
}  // namespace hermite
