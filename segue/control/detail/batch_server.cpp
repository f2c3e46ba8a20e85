// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/batch_server.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>

#include <algorithm>
#include <utility>
#include <variant>

namespace segue::control::detail {

namespace {

using Outcomes = std::vector<task_host::Completed>;

/// A batch in progress; used in the loop's thread only, and lets go of all that belongs there when it has
/// ended.
class Batch final : private kj::TaskSet::ErrorHandler {
 public:
  Batch(Caller caller, Follower follower, std::uint64_t ticket, std::size_t count)
      : caller_(std::move(caller)),
        follower_(std::move(follower)),
        ticket_(ticket),
        outcomes_(count),
        open_(count),
        sending_(new kj::TaskSet(*this)) {}

  kj::Promise<Result<Outcomes>> answer() {
    auto pair = kj::newPromiseAndFulfiller<Result<Outcomes>>();
    done_ = kj::mv(pair.fulfiller);
    return kj::mv(pair.promise);
  }

  void take(std::vector<task_host::Completed> ended) {
    if (sending_ == nullptr) return;
    open_ -= ended.size();
    for (auto& one : ended) {
      unreported_.push_back(one.index);
      outcomes_[one.index] = std::move(one);
    }
    open_ == 0 ? finish(std::move(outcomes_)) : report();
  }

  /// The service broke down: all of it failed, whatever ended before.
  void finish(Result<Outcomes> outcomes) {
    sending_.reset();
    follower_.reset();
    caller_.end_batch();
    caller_.core().batches.remove();
    (*std::exchange(done_, nullptr)).fulfill(std::move(outcomes));
  }

 private:
  /// One message at a time is on its way. The answer has all outcomes, so those that still wait then are
  /// dropped.
  void report() {
    KJ_IF_MAYBE (follower, *follower_) {
      if (busy_ || unreported_.empty()) return;
      busy_ = true;
      auto request = follower->reportRequest();
      request.setTicket(ticket_);
      auto list = request.initEnded(count_of(unreported_));
      for (unsigned i = 0; i < list.size(); ++i) {
        encode(outcomes_[unreported_[i]], list[i]);
      }
      unreported_.clear();
      sending_->add(request.send().ignoreResult().then([this] {
        busy_ = false;
        report();
      }));
    }
  }

  /// The client is gone or refuses reports: it stays busy, so none is sent any more.
  void taskFailed(kj::Exception&&) override {}

  Caller caller_;
  Follower follower_;
  const std::uint64_t ticket_;
  Outcomes outcomes_;
  std::size_t open_;
  std::vector<std::size_t> unreported_;
  bool busy_ = false;
  std::unique_ptr<kj::TaskSet> sending_;
  kj::Own<kj::PromiseFulfiller<Result<Outcomes>>> done_;
};

/// The environment of a process decides which libraries are loaded into it, so only a client that may start
/// any process may set it.
Result<void> may_begin(const Caller& caller, const std::vector<model::Action>& actions) {
  const bool sets_environment = std::ranges::any_of(actions, [](const model::Action& action) {
    const auto* deployment = std::get_if<model::DeploymentAction>(&action.what);
    return deployment != nullptr && !deployment->deployment.environment.empty();
  });
  return sets_environment ? caller.require(Role::Administer) : Result<void>();
}

}  // namespace

kj::Promise<Result<Outcomes>> perform_batch(Caller caller, std::shared_ptr<void> service, Follower follower,
                                            std::uint64_t ticket, std::vector<model::Action> actions,
                                            const BeginBatch& begin) {
  if (auto allowed = may_begin(caller, actions); !allowed) return Result<Outcomes>(allowed.error());
  if (auto begun = caller.begin_batch(); !begun) return Result<Outcomes>(begun.error());
  if (actions.empty()) {
    caller.end_batch();
    return Result<Outcomes>(Outcomes());
  }
  ServerCore& core = caller.core();
  const std::size_t count = actions.size();
  const auto batch = std::make_shared<Batch>(caller, std::move(follower), ticket, count);
  auto answer = batch->answer();
  core.batches.add();
  auto completed = [&core, batch, service = std::move(service)](std::vector<task_host::Completed> ended) {
    core.loop.post(
        [batch, ended = std::move(ended)](kj::AsyncIoContext&) mutable { batch->take(std::move(ended)); });
  };
  try {
    begin(std::move(actions), std::move(completed));
  } catch (...) {
    batch->finish(thrown_by_service(core.noun()));
  }
  return answer;
}

}  // namespace segue::control::detail
