// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/host/task_host.hpp>
#include <segue/model/action_times.hpp>

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace segue::host {

/// Threads that carry out batches of actions whose hooks may take long or never return. A batch runs on one
/// thread, one action after the other in their order; only where one takes longer than some time does the
/// rest go on on another thread, and what has ended is told. So quick batches cost one hand-over between
/// threads, and slow actions hold nobody up. All functions may be called from any thread.
class Crew {
 public:
  /// Carries out one action; exceptions count as failures of it.
  using Work = std::function<Result<void>(const model::Action& action, TimePoint deadline)>;

  /// The rest of a batch goes on on another thread where an action takes longer than `patience`.
  explicit Crew(Work work, Duration patience = model::kQuickAction);
  /// close().
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Begins a batch and returns at once. `completed` is told every action once, as TaskHost::perform_all
  /// says; what does not end goes on by itself after its deadline, untold.
  void begin(std::vector<model::Action> actions, TimePoint deadline, Completion completed);
  /// Carries out a batch and returns when all are told.
  void run(std::span<const model::Action> actions, TimePoint deadline, const Completion& completed);
  /// The same, and the caller's thread begins: without any hand-over where all is quick. For actions without
  /// hooks only, since it does not return before the action that the caller's thread is at.
  void run_here(std::span<const model::Action> actions, TimePoint deadline, const Completion& completed);

  /// Waits for all that is at work, whatever its deadline; what is begun afterwards is Unavailable.
  void close();

 private:
  struct Implementation;
  std::shared_ptr<Implementation> implementation_;
};

}  // namespace segue::host
