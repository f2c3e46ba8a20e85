// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/left_actions.hpp>
#include <segue/runtime/pending.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/transaction.hpp>

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// Says whose turn it is: at most one request and one set of applied files wait, a newer one takes the place
/// of an older one, and what is being executed gives way to what waits. One worker takes from it; all other
/// functions may be called from any thread, and none of these blocks.
///
/// Functions that are handed over are called with the queue locked, so what they do and what the queue does
/// is one step. They must not call the queue, or the host, whose events reach the queue. The belief, the log,
/// leases, halts and controllers have locks of their own, which may be taken within.
class RequestQueue {
 public:
  /// `log` must outlive this.
  explicit RequestQueue(EventLog& log);

  // The request and the files that wait for the worker.
  struct Waiting {
    std::optional<PendingRequest> request{};
    std::optional<PendingApply> files{};
  };
  /// `admit` says whether it may take its place. Its number is known then. It is moved from only where it
  /// may.
  struct Place {
    std::uint64_t number = 0;
    std::optional<PendingRequest> older{};  ///< whose place it takes
  };
  Place put(PendingRequest& job, const std::function<bool()>& admit);
  /// As above; `admit` gets the files whose place these take, or null. Returns them.
  std::optional<PendingApply> put(PendingApply& job, const std::function<bool(PendingApply* older)>& admit);
  /// Goes before everything: nothing else waits any more, and what is prepared, retired or undone gives way.
  /// `accepted` is called with the number of the request. Returns what waited.
  Waiting put_before_all(PendingRequest job, const std::function<void(std::uint64_t number)>& accepted);
  /// Files of which nothing has been executed wait again. False where they do not, as newer ones wait, which
  /// go back to what was before these, or the runtime ends.
  bool postpone(PendingApply& job);
  /// Files whose transition has failed. `restore` gets the definitions from before, but where newer files
  /// wait, which go back to these.
  void take_back(PendingApply& job, const std::function<void(Definitions before)>& restore);

  // Cancelling, and what is open
  struct Cancelled {
    std::optional<PendingRequest> withdrawn{};          ///< it has not begun
    std::optional<std::future<SwitchResult>> ending{};  ///< it has; how it ends
  };
  /// The request of that number, or with 0 the one that waits, or else the one that is executed. NotFound
  /// where it is not open, InvalidState where it can be cancelled no longer.
  Result<Cancelled> cancel(std::uint64_t request, const std::string& who);
  [[nodiscard]] std::vector<OpenRequest> open() const;
  /// Numbers of open requests that were made with this lease.
  [[nodiscard]] std::vector<std::uint64_t> open_with(std::uint64_t lease) const;

  // The state
  [[nodiscard]] RuntimeState state() const;
  /// Something is executed, or waits to be.
  [[nodiscard]] bool is_active() const;
  /// The state is Executing until settle(); nothing, and nothing is done, where something waits.
  [[nodiscard]] std::optional<RuntimeState> begin_unless_waiting();
  /// Ends the state Executing. Returns what was postponed meanwhile.
  std::optional<std::optional<model::Network>> settle(RuntimeState next);
  /// A reset of the belief to `network` waits until settle(); false where nothing is executed.
  bool postpone_reset(std::optional<model::Network>& network);
  /// Idle, if it was Failed.
  void forget_failure();

  // The worker
  /// Taken from the queue; the state is Executing where there is a job. Neither: the robot is to be looked
  /// at.
  struct Turn {
    Waiting job{};
    RuntimeState before = RuntimeState::Idle;
  };
  /// Blocks until it is somebody's turn, or until `supervision`; nothing: the runtime ends.
  std::optional<Turn> next(TimePoint supervision);
  /// The worker looks at the robot as soon as it is idle.
  void wake();
  /// The transition of the request whose turn it is, or one that was not requested, is executed. It gives way
  /// at once to what waits already.
  void begin(const std::shared_ptr<Transaction>& transaction, Cause cause);
  /// It is not executed any more.
  void end_transaction();
  /// It is this one's turn: files whose controller changes.
  void serve(ServedRequest request);
  /// Answers those who have cancelled the request of this result.
  void conclude(const SwitchResult& result);
  /// Whether a request waits.
  [[nodiscard]] bool has_request() const;
  /// The runtime ends: what is executed is abandoned. Returns what waited.
  Waiting stop();
  [[nodiscard]] bool is_stopped() const;

  /// Of transactions that made way. Has its own lock.
  [[nodiscard]] const std::shared_ptr<LeftActions>& left_actions() const { return left_actions_; }

 private:
  [[nodiscard]] bool may_serve() const SEGUE_REQUIRES(mutex_);
  Result<std::future<SwitchResult>> cancel_served(const std::string& who) SEGUE_REQUIRES(mutex_);
  Turn take_turn() SEGUE_REQUIRES(mutex_);

  EventLog& log_;
  const std::shared_ptr<LeftActions> left_actions_;
  mutable Mutex mutex_;  ///< protects all below; not held while the host is called
  ConditionVariable wake_;
  bool stopped_ SEGUE_GUARDED_BY(mutex_) = false;
  bool wake_requested_ SEGUE_GUARDED_BY(mutex_) = false;
  std::uint64_t last_ SEGUE_GUARDED_BY(mutex_) = 0;
  Waiting waiting_ SEGUE_GUARDED_BY(mutex_);
  std::optional<ServedRequest> served_ SEGUE_GUARDED_BY(mutex_);
  std::shared_ptr<Transaction> transaction_ SEGUE_GUARDED_BY(mutex_);
  /// It only prepares or collects, or is about a pool, so files that are applied supersede it.
  bool transaction_yields_ SEGUE_GUARDED_BY(mutex_) = false;
  RuntimeState state_ SEGUE_GUARDED_BY(mutex_) = RuntimeState::Idle;
  std::optional<std::optional<model::Network>> reset_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail
