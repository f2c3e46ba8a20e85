// SPDX-License-Identifier: Apache-2.0
#include "box_qp.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace manipulation {
namespace {

using Vector = BoxQp::Vector;
using Matrix = BoxQp::Matrix;

Vector some_vector(Eigen::Index size, double largest) {
  Vector vector(size);
  for (Eigen::Index i = 0; i < size; ++i)
    vector[i] = largest * *rc::gen::inRange(-1'000'000, 1'000'001) / 1e6;
  return vector;
}

struct Problem {
  Matrix H;
  Vector g;
  Vector lower;
  Vector upper;
  [[nodiscard]] double cost(const Vector& x) const { return 0.5 * x.dot(H * x) + g.dot(x); }
};

/// Like those of a robot: a few tasks, and a little damping where they leave the joints free.
Problem some_problem(Eigen::Index size) {
  Problem p;
  const double damping = *rc::gen::element(1e-4, 1e-2, 1.0);
  p.H = damping * Matrix::Identity(size, size);
  const int tasks = *rc::gen::inRange(0, 7);
  for (int i = 0; i < tasks; ++i) {
    const Vector row = some_vector(size, 1);
    p.H += row * row.transpose();
  }
  p.g = some_vector(size, 2);
  const Vector one = some_vector(size, 1);
  const Vector other = *rc::gen::arbitrary<bool>() ? one : some_vector(size, 1);
  p.lower = one.cwiseMin(other);
  p.upper = one.cwiseMax(other);
  for (Eigen::Index i = 0; i < size; ++i) {
    if (*rc::gen::inRange(0, 4) == 0) p.upper[i] = 100;
    if (*rc::gen::inRange(0, 4) == 0) p.lower[i] = -100;
  }
  return p;
}

RC_GTEST_PROP(BoxQp, ItsSolutionSatisfiesTheConditionsOfKarushKuhnAndTucker, ()) {
  const Eigen::Index size = *rc::gen::inRange(1, BoxQp::kMost + 1);
  const Problem p = some_problem(size);
  Vector x = some_vector(*rc::gen::inRange<Eigen::Index>(0, size + 1), 3);
  BoxQp qp;
  RC_ASSERT(qp.solve(p.H, p.g, p.lower, p.upper, x));
  const Vector gradient = p.H * x + p.g;
  for (Eigen::Index i = 0; i < size; ++i) {
    RC_ASSERT(x[i] >= p.lower[i] && x[i] <= p.upper[i]);
    const bool at_lower = x[i] == p.lower[i];
    const bool at_upper = x[i] == p.upper[i];
    RC_ASSERT(at_lower || gradient[i] <= 1e-6);
    RC_ASSERT(at_upper || gradient[i] >= -1e-6);
  }
  Vector again = x;
  RC_ASSERT(qp.solve(p.H, p.g, p.lower, p.upper, again));
  RC_ASSERT(qp.steps() <= 1);
  RC_ASSERT((again - x).norm() < 1e-6);
}

/// Tries every combination of limits.
double lowest_cost(const Problem& p) {
  const Eigen::Index size = p.g.size();
  double best = std::numeric_limits<double>::infinity();
  int combinations = 1;
  for (Eigen::Index i = 0; i < size; ++i)
    combinations *= 3;
  for (int combination = 0; combination < combinations; ++combination) {
    Matrix H = p.H;
    Vector right = -p.g;
    int rest = combination;
    for (Eigen::Index i = 0; i < size; ++i, rest /= 3) {
      if (rest % 3 == 0) continue;
      H.row(i).setZero();
      H(i, i) = 1;
      right[i] = rest % 3 == 1 ? p.lower[i] : p.upper[i];
    }
    const Eigen::MatrixXd rows = H;
    const Eigen::VectorXd x = rows.fullPivLu().solve(Eigen::VectorXd(right));
    if (((x - p.lower).array() < -1e-9).any() || ((p.upper - x).array() < -1e-9).any()) continue;
    best = std::min(best, p.cost(x));
  }
  return best;
}

RC_GTEST_PROP(BoxQp, NoOtherCombinationOfLimitsIsBetter, ()) {
  const Problem p = some_problem(*rc::gen::inRange(1, 6));
  Vector x;
  BoxQp qp;
  RC_ASSERT(qp.solve(p.H, p.g, p.lower, p.upper, x));
  const double best = lowest_cost(p);
  RC_ASSERT(std::isfinite(best));
  RC_ASSERT(p.cost(x) <= best + 1e-8);
}

TEST(BoxQp, StaysWithinItsLimitsWhereTheProblemIsNoNumber) {
  BoxQp qp;
  Vector x = Vector::Zero(2);
  Matrix H = Matrix::Identity(2, 2);
  H(0, 0) = std::nan("");
  const Vector limit = Vector::Ones(2);
  EXPECT_FALSE(qp.solve(H, Vector::Ones(2), -limit, limit, x));
  EXPECT_TRUE((x.array().abs() <= 1).all());
}

}  // namespace
}  // namespace manipulation
