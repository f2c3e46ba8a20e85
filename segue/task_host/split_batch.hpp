// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/concurrent/thread_pool.hpp>
#include <segue/task_host/batch_outcomes.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace segue::task_host {

/// A batch whose actions are carried out at several places: processes or computers. Made by
/// std::make_shared: whatever works on it keeps it. All functions may be called from any thread.
class SplitBatch : public BatchOutcomes, public std::enable_shared_from_this<SplitBatch> {
 public:
  using BatchOutcomes::BatchOutcomes;

  using Indices = std::vector<std::size_t>;
  /// Is told how an action has ended, before that is reported.
  using Note = std::function<void(const model::Action& action, const Result<void>& outcome)>;
  /// For one place that carries out the actions of `indices` as a batch of its own, in that order.
  [[nodiscard]] Completion part(Indices indices, Note note);
  /// Reports that these actions failed.
  void fail(const Indices& indices, const Error& why);
  /// Carries out an action by `work`, on a thread of the pool, or on this one where that has none.
  void run(concurrent::ThreadPool& pool, std::size_t index, std::function<Result<void>()> work);
};

}  // namespace segue::task_host
