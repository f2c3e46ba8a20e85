// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/request_queue.hpp>

#include <string_view>
#include <utility>

namespace segue::runtime::detail {

namespace {

std::string_view name_of_stage(Transaction::Stage stage) {
  switch (stage) {
    case Transaction::Stage::Prepare:
      return "prepare";
    case Transaction::Stage::Commit:
      return "commit";
    case Transaction::Stage::Committed:
    case Transaction::Stage::Retire:
      return "retire";
    case Transaction::Stage::Undo:
      return "undo";
  }
  return "";
}

}  // namespace

RequestQueue::RequestQueue(EventLog& log)
    : log_(log), left_actions_(std::make_shared<LeftActions>([this] { wake(); })) {}

RequestQueue::Place RequestQueue::put(PendingRequest& job, const std::function<bool()>& admit) {
  Place place;
  {
    const Lock lock(mutex_);
    place.number = job.number = ++last_;
    if (!admit()) {
      return place;
    }
    place.older = std::exchange(waiting_.request, std::move(job));
    const auto& parts = waiting_.request->parts;
    if (transaction_) {
      // The transition may be look-ahead, which prepares for a controller that nobody wants now, or make an
      // instance of a pool, for which only a request waits that ends it.
      const bool yields = transaction_yields_ && !waiting_.request->privileges.ends_pools;
      if (parts && yields) {
        transaction_->make_way(*parts);
      } else {
        transaction_->supersede();
      }
    }
  }
  wake_.notify_all();
  return place;
}

std::optional<PendingApply> RequestQueue::put(PendingApply& job,
                                              const std::function<bool(PendingApply* older)>& admit) {
  std::optional<PendingApply> older;
  {
    const Lock lock(mutex_);
    job.number = ++last_;
    if (!admit(waiting_.files ? &*waiting_.files : nullptr)) {
      return std::nullopt;
    }
    older = std::exchange(waiting_.files, std::move(job));
    if (transaction_ && transaction_yields_) {
      transaction_->supersede();
    }
  }
  wake_.notify_all();
  return older;
}

RequestQueue::Waiting RequestQueue::put_before_all(
    PendingRequest job, const std::function<void(std::uint64_t number)>& accepted) {
  Waiting dropped;
  {
    const Lock lock(mutex_);
    dropped = std::exchange(waiting_, {});
    job.number = ++last_;
    accepted(job.number);
    waiting_.request = std::move(job);
    if (transaction_) {
      transaction_->make_way_to_rest(waiting_.request->parts.value_or(NetworkParts()));
    }
  }
  wake_.notify_all();
  return dropped;
}

bool RequestQueue::postpone(PendingApply& job) {
  const Lock lock(mutex_);
  if (stopped_) {
    return false;
  }
  if (waiting_.files) {
    waiting_.files->before = std::move(job.before);
    return false;
  }
  waiting_.files = std::move(job);
  return true;
}

void RequestQueue::take_back(PendingApply& job, const std::function<void(Definitions before)>& restore) {
  const Lock lock(mutex_);
  if (waiting_.files) {
    waiting_.files->before = std::move(job.before);
    return;
  }
  restore(std::move(job.before));
}

Result<RequestQueue::Cancelled> RequestQueue::cancel(std::uint64_t request, const std::string& who) {
  const Lock lock(mutex_);
  if (waiting_.request && (request == 0 || request == waiting_.request->number)) {
    Cancelled withdrawn;
    withdrawn.withdrawn.swap(waiting_.request);
    return withdrawn;
  }
  if (served_ && (request == 0 || request == served_->number)) {
    auto ending = cancel_served(who);
    if (!ending) {
      return std::move(ending.error());
    }
    return Cancelled{{}, std::move(*ending)};
  }
  return fail(ErrorCode::NotFound,
              request == 0 ? "there is nothing to cancel: no request is in progress"
                           : "request " + std::to_string(request) + " is not in progress (any more)");
}

Result<std::future<SwitchResult>> RequestQueue::cancel_served(const std::string& who) {
  if (served_->ended) {
    return fail(ErrorCode::InvalidState, "it has just ended", served_->to.str());
  }
  const bool is_new = !served_->cancelled_by;
  if (transaction_) {
    auto accepted = transaction_->cancel(who);
    if (!accepted) {
      return std::move(accepted.error());
    }
    served_->cancelled_by = std::move(*accepted);
  } else if (is_new) {
    served_->cancelled_by = who;  // it is being planned
  }
  if (is_new) {
    log_.add(EventKind::RequestCancelled, served_->to.str(), "by " + who);
  }
  return served_->cancelled.emplace_back().get_future();
}

std::vector<OpenRequest> RequestQueue::open() const {
  const Lock lock(mutex_);
  std::vector<OpenRequest> open;
  if (served_ && !served_->ended) {
    open.push_back({served_->number, served_->to, served_->who,
                    transaction_ ? name_of_stage(transaction_->stage()) : "planning",
                    served_->cancelled_by.value_or("")});
  }
  if (const auto& waits = waiting_.request) {
    open.push_back({waits->number, name_of(waits->request), waits->options.who, "waiting", ""});
  }
  return open;
}

std::vector<std::uint64_t> RequestQueue::open_with(std::uint64_t lease) const {
  const Lock lock(mutex_);
  std::vector<std::uint64_t> open;
  if (served_ && served_->lease == lease) {
    open.push_back(served_->number);
  }
  if (waiting_.request && waiting_.request->options.lease == lease) {
    open.push_back(waiting_.request->number);
  }
  return open;
}

bool RequestQueue::has_request() const {
  const Lock lock(mutex_);
  return waiting_.request.has_value();
}

RuntimeState RequestQueue::state() const {
  const Lock lock(mutex_);
  return state_;
}

bool RequestQueue::is_active() const {
  const Lock lock(mutex_);
  return state_ == RuntimeState::Executing || waiting_.request || waiting_.files ||
         (served_ && !served_->ended);
}

std::optional<RuntimeState> RequestQueue::begin_unless_waiting() {
  const Lock lock(mutex_);
  if (stopped_ || waiting_.request || waiting_.files) {
    return std::nullopt;
  }
  return std::exchange(state_, RuntimeState::Executing);
}

std::optional<std::optional<model::Network>> RequestQueue::settle(RuntimeState next) {
  const Lock lock(mutex_);
  state_ = next;
  return std::exchange(reset_, std::nullopt);
}

bool RequestQueue::postpone_reset(std::optional<model::Network>& network) {
  const Lock lock(mutex_);
  if (state_ != RuntimeState::Executing) {
    return false;
  }
  reset_ = std::move(network);
  return true;
}

void RequestQueue::forget_failure() {
  const Lock lock(mutex_);
  if (state_ == RuntimeState::Failed) {
    state_ = RuntimeState::Idle;
  }
}

/// Not while something is left in progress that it needs.
bool RequestQueue::may_serve() const {
  if (!waiting_.request) {
    return false;
  }
  const auto& parts = waiting_.request->parts;
  return parts ? !left_actions_->concern(*parts) : !left_actions_->any();
}

std::optional<RequestQueue::Turn> RequestQueue::next(TimePoint supervision) {
  const Lock lock(mutex_);
  wake_.wait_until(mutex_, supervision, [&]() SEGUE_REQUIRES(mutex_) {
    return stopped_ || may_serve() || waiting_.files || wake_requested_;
  });
  if (waiting_.request) {
    wake_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return stopped_ || !waiting_.request || may_serve(); });
  }
  if (stopped_) {
    return std::nullopt;
  }
  return take_turn();
}

RequestQueue::Turn RequestQueue::take_turn() {
  Turn turn;
  if (waiting_.request) {
    turn.job.request.swap(waiting_.request);
    const PendingRequest& job = *turn.job.request;
    served_.emplace(ServedRequest{job.number, name_of(job.request), job.options.who, job.options.lease});
  } else if (waiting_.files) {
    turn.job.files.swap(waiting_.files);
  } else {
    wake_requested_ = false;
    return turn;
  }
  turn.before = std::exchange(state_, RuntimeState::Executing);
  return turn;
}

void RequestQueue::wake() {
  {
    const Lock lock(mutex_);
    wake_requested_ = true;
  }
  wake_.notify_all();
}

void RequestQueue::begin(const std::shared_ptr<Transaction>& transaction, Cause cause) {
  const Lock lock(mutex_);
  transaction_ = transaction;
  transaction_yields_ = cause == Cause::LookAhead || cause == Cause::Collect || cause == Cause::Pool;
  if (stopped_) {
    transaction->abandon();
  } else if (served_ && served_->cancelled_by) {
    (void)transaction->cancel(*served_->cancelled_by);
  } else if (waiting_.request || (waiting_.files && transaction_yields_)) {
    transaction->supersede();
  }
}

void RequestQueue::end_transaction() {
  const Lock lock(mutex_);
  transaction_.reset();
  if (served_) {
    served_->ended = true;
  }
}

void RequestQueue::serve(ServedRequest request) {
  const Lock lock(mutex_);
  served_.emplace(std::move(request));
}

void RequestQueue::conclude(const SwitchResult& result) {
  const Lock lock(mutex_);
  if (!served_ || served_->number != result.request) {
    return;
  }
  for (auto& promise : served_->cancelled) {
    promise.set_value(result);
  }
  served_.reset();
}

RequestQueue::Waiting RequestQueue::stop() {
  Waiting left;
  {
    const Lock lock(mutex_);
    stopped_ = true;
    left = std::exchange(waiting_, {});
    if (transaction_) {
      transaction_->abandon();
    }
  }
  wake_.notify_all();
  return left;
}

bool RequestQueue::is_stopped() const {
  const Lock lock(mutex_);
  return stopped_;
}

}  // namespace segue::runtime::detail
