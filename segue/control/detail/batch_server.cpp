// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/batch_server.hpp>
#include <segue/control/detail/deployment_wire.hpp>
#include <segue/host/batch_outcomes.hpp>

#include <atomic>
#include <utility>

namespace segue::control::detail {

namespace {

using Outcomes = std::vector<host::Completed>;

/// A batch on its way; lives in the loop's thread, and lets go of all that belongs there when it has ended.
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

  /// Each action comes once.
  void take(std::vector<host::Completed> ended) {
    open_ -= ended.size();
    for (auto& one : ended) {
      untold_.push_back(one.index);
      outcomes_[one.index] = std::move(one);
    }
    open_ == 0 ? finish() : tell();
  }

 private:
  void finish() {
    sending_.reset();
    follower_.reset();
    caller_.end();
    (*std::exchange(done_, nullptr)).fulfill(std::move(outcomes_));
  }

  /// One message at a time is on its way; the answer has all, so what waits then is dropped.
  void tell() {
    KJ_IF_MAYBE (follower, *follower_) {
      if (busy_ || untold_.empty()) return;
      busy_ = true;
      auto request = follower->toldRequest();
      request.setTicket(ticket_);
      auto list = request.initEnded(count_of(untold_));
      for (unsigned i = 0; i < list.size(); ++i) {
        encode(outcomes_[untold_[i]], list[i]);
      }
      untold_.clear();
      sending_->add(request.send().ignoreResult().then([this] {
        busy_ = false;
        tell();
      }));
    }
  }

  /// The client is gone or does not want to be told: it stays busy for good.
  void taskFailed(kj::Exception&&) override {}

  Caller caller_;
  Follower follower_;
  const std::uint64_t ticket_;
  Outcomes outcomes_;
  std::size_t open_;
  std::vector<std::size_t> untold_;
  bool busy_ = false;
  std::unique_ptr<kj::TaskSet> sending_;
  kj::Own<kj::PromiseFulfiller<Result<Outcomes>>> done_;
};

}  // namespace

kj::Promise<Result<Outcomes>> perform_batch(Caller caller, Follower follower, std::uint64_t ticket,
                                            std::vector<model::Action> actions, TimePoint deadline) {
  if (auto begun = caller.begin(); !begun) return Result<Outcomes>(begun.error());
  if (actions.empty()) {
    caller.end();
    return Result<Outcomes>(Outcomes());
  }
  ServerCore& core = caller.core();
  const std::size_t count = actions.size();
  const auto batch = std::make_shared<Batch>(caller, std::move(follower), ticket, count);
  auto answer = batch->answer();
  core.batches.add();
  const auto told = std::make_shared<host::BatchOutcomes>(
      count, [&core, batch, open = count](std::vector<host::Completed> ended) mutable {
        open -= ended.size();
        core.loop.post([batch, ended = std::move(ended)](kj::AsyncIoContext&) mutable {
          batch->take(std::move(ended));
        });
        if (open == 0) core.batches.remove();
      });
  try {
    core.service<deploy::DeploymentService>().begin_all(
        std::move(actions), deadline,
        [told](std::vector<host::Completed> ended) { told->add(std::move(ended)); });
  } catch (...) {
    const Error error = thrown_by_service(core.noun());
    told->fail_rest([&](std::size_t) { return error; });
  }
  return answer;
}

}  // namespace segue::control::detail
