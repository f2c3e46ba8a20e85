// SPDX-License-Identifier: Apache-2.0
#include "box_qp.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace manipulation {

bool BoxQp::solve(const Matrix& H, const Vector& g, const Vector& lower, const Vector& upper, Vector& x) {
  const Eigen::Index size = g.size();
  x = x.size() == size && x.allFinite() ? Vector(x.cwiseMax(lower).cwiseMin(upper))
                                        : Vector(Vector::Zero(size).cwiseMax(lower).cwiseMin(upper));
  for (Eigen::Index i = 0; i < size; ++i) {
    bounds_[static_cast<std::size_t>(i)] = x[i] <= lower[i]   ? Bound::Lower
                                           : x[i] >= upper[i] ? Bound::Upper
                                                              : Bound::Free;
  }
  const double scale = 1 + g.lpNorm<Eigen::Infinity>() + H.lpNorm<Eigen::Infinity>();
  const double tolerance = 1e-10 * scale;
  const int most_steps = 20 + 10 * static_cast<int>(size);
  for (steps_ = 0; steps_ < most_steps; ++steps_) {
    const Vector gradient = H * x + g;
    const Vector step = step_to_minimum(H, gradient);
    if (!step.allFinite()) return false;
    move(step, lower, upper, x);
    if (const Vector left = H * x + g; !release(left, lower, upper, tolerance)) return true;
  }
  return false;
}

/// The step of the free variables to the minimum; zero for the others.
BoxQp::Vector BoxQp::step_to_minimum(const Matrix& H, const Vector& gradient) const {
  const Eigen::Index size = gradient.size();
  std::array<Eigen::Index, kMost> free{};
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < size; ++i) {
    if (bounds_[static_cast<std::size_t>(i)] == Bound::Free) free[static_cast<std::size_t>(count++)] = i;
  }
  Matrix part(count, count);
  Vector right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index row = free[static_cast<std::size_t>(i)];
    right[i] = -gradient[row];
    for (Eigen::Index j = 0; j < count; ++j)
      part(i, j) = H(row, free[static_cast<std::size_t>(j)]);
  }
  Vector step = Vector::Zero(size);
  if (count == 0) return step;
  const Eigen::LLT<Matrix> factors(part);
  const Vector solution = factors.solve(right);
  for (Eigen::Index i = 0; i < count; ++i)
    step[free[static_cast<std::size_t>(i)]] = solution[i];
  return step;
}

/// Moves `x` along `step` as far as the limits allow; the variable that meets its limit first stays there.
void BoxQp::move(const Vector& step, const Vector& lower, const Vector& upper, Vector& x) {
  double share = 1;
  Eigen::Index blocking = -1;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (bounds_[static_cast<std::size_t>(i)] != Bound::Free || step[i] == 0) continue;
    const double room = std::max(0.0, (step[i] > 0 ? upper[i] - x[i] : lower[i] - x[i]) / step[i]);
    if (room >= share) continue;
    share = room;
    blocking = i;
  }
  x += share * step;
  if (blocking >= 0) {
    const bool up = step[blocking] > 0;
    x[blocking] = up ? upper[blocking] : lower[blocking];
    bounds_[static_cast<std::size_t>(blocking)] = up ? Bound::Upper : Bound::Lower;
  }
  x = x.cwiseMax(lower).cwiseMin(upper);
}

/// Whether there is more to do: free variables are not at their minimum yet, or one that was at a limit has
/// been freed because it wants to leave it.
bool BoxQp::release(const Vector& gradient, const Vector& lower, const Vector& upper, double tolerance) {
  double worst = tolerance;
  Eigen::Index leaving = -1;
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    const Bound bound = bounds_[static_cast<std::size_t>(i)];
    if (bound == Bound::Free && std::abs(gradient[i]) > tolerance) return true;
    if (bound == Bound::Free || lower[i] == upper[i]) continue;
    const double pull = bound == Bound::Lower ? -gradient[i] : gradient[i];
    if (pull <= worst) continue;
    worst = pull;
    leaving = i;
  }
  if (leaving < 0) return false;
  bounds_[static_cast<std::size_t>(leaving)] = Bound::Free;
  return true;
}

}  // namespace manipulation
