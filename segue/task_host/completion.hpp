// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

/// How actions of a batch end, and who is told.
namespace segue::task_host {

/// A begin and an end, relative to a common begin.
struct Span {
  Duration begin{0};
  Duration end{0};
  friend bool operator==(const Span&, const Span&) = default;
};

/// How one action of a batch has ended.
struct Completed {
  std::size_t index = 0;  ///< its place in the batch
  Result<void> outcome;
  std::optional<Duration> took{};  ///< from its own begin to its end; only where it was measured
  // Of actions in their partial order:
  std::optional<Span> span{};  ///< since the begin of all of them, until the end was known
  bool begun = true;           ///< false: it never began, since another one failed or all were stopped
};

/// Gets the actions of a batch that have ended since the last call, at least one. Called from any thread,
/// also before the function that begins the batch returns, and by several threads at the same time. Must not
/// block; may begin other batches.
using Completion = std::function<void(std::vector<Completed>)>;

/// Calls `begin` with a Completion, waits until it has got `count` actions, and returns their outcomes in the
/// order of their indices.
std::vector<Result<void>> wait_for_outcomes(std::size_t count, const std::function<void(Completion)>& begin);

/// The ends of a batch of `count` actions of which each failed for the same reason.
std::vector<Completed> all_failed(std::size_t count, const Error& why);

}  // namespace segue::task_host
