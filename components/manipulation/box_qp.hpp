// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace manipulation {

/// Small quadratic programs whose variables have limits: minimise x'Hx/2 + g'x within lower <= x <= upper.
/// Primal active-set method (Nocedal and Wright, "Numerical Optimization", chapter 16.5): a bounded number of
/// steps, and x lies within its limits whenever it ends. Never allocates. One thread at a time.
class BoxQp {
 public:
  static constexpr int kMost = 16;  ///< variables
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  /// Requires a positive definite H of at most kMost rows, and lower <= upper. Begins at `x`, as it should
  /// from one control cycle to the next, and leaves the solution there. False if it had to give up: x then is
  /// the best that was found.
  bool solve(const Matrix& H, const Vector& g, const Vector& lower, const Vector& upper, Vector& x);
  /// The number of steps of the last solve().
  [[nodiscard]] int steps() const { return steps_; }

 private:
  enum class Bound : std::uint8_t { Free, Lower, Upper };
  [[nodiscard]] Vector step_to_minimum(const Matrix& H, const Vector& gradient) const;
  bool release(const Vector& gradient, const Vector& lower, const Vector& upper, double tolerance);
  void move(const Vector& step, const Vector& lower, const Vector& upper, Vector& x);

  std::array<Bound, kMost> bounds_{};
  int steps_ = 0;
};

}  // namespace manipulation
