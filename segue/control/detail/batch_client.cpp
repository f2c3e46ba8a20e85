// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/batch_client.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/batch_outcomes.hpp>

#include <map>
#include <utility>

namespace segue::control::detail {

/// Batches that have not ended, by their tickets. Used in the loop only.
class BatchClient::Open {
 public:
  std::uint64_t add(const std::shared_ptr<task_host::BatchOutcomes>& batch) {
    batches_.emplace(++last_, batch);
    return last_;
  }
  void remove(const std::shared_ptr<task_host::BatchOutcomes>& batch) {
    std::erase_if(batches_, [&](const auto& item) { return item.second == batch; });
  }
  [[nodiscard]] std::shared_ptr<task_host::BatchOutcomes> find(std::uint64_t ticket) const {
    const auto found = batches_.find(ticket);
    return found == batches_.end() ? nullptr : found->second;
  }
  void fail_all(const Error& why) {
    for (const auto& [ticket, batch] : std::exchange(batches_, {}))
      batch->fail_rest(why);
  }
  /// True the first time.
  bool follow() { return !std::exchange(following_, true); }

 private:
  std::map<std::uint64_t, std::shared_ptr<task_host::BatchOutcomes>> batches_;
  std::uint64_t last_ = 0;
  bool following_ = false;
};

namespace {

/// Takes the ends that a process reports early.
template <class Open>
class FollowerServer final : public wire::BatchFollower::Server {
 public:
  explicit FollowerServer(std::shared_ptr<Open> open) : open_(std::move(open)) {}

  kj::Promise<void> report(ReportContext context) override {
    const auto params = context.getParams();
    if (const auto batch = open_->find(params.getTicket())) {
      std::vector<task_host::Completed> ended;
      for (const auto one : params.getEnded())
        ended.push_back(decode(one));
      batch->add(std::move(ended));
    }
    return kj::READY_NOW;
  }

 private:
  const std::shared_ptr<Open> open_;
};

}  // namespace

BatchClient::BatchClient(std::shared_ptr<RpcChannel> channel, TasksOf tasks)
    : channel_(std::move(channel)), tasks_(std::move(tasks)), open_(std::make_shared<Open>()) {}

BatchClient::~BatchClient() {
  channel_->run([this] { open_->fail_all(fail(ErrorCode::Unavailable, "the connection is closed")); });
}

void BatchClient::begin(std::vector<model::Action> actions, TimePoint deadline,
                        task_host::Completion completed) {
  const Duration left = time_left(deadline);
  auto send_request = [left](wire::TaskAccess::Client access, const std::vector<model::Action>& what,
                             std::uint64_t ticket) {
    return send(access.performRequest(), what, left, ticket);
  };
  begin(std::move(actions), left, std::move(send_request), std::move(completed));
}

void BatchClient::begin(std::vector<model::Action> actions, Duration timeout, Send send,
                        task_host::Completion completed) {
  if (actions.empty()) return;
  const auto batch = std::make_shared<task_host::BatchOutcomes>(std::move(actions), std::move(completed));
  auto ask = [batch, send = std::move(send), tasks = tasks_, open = open_,
              who = channel_->who()](RpcChannel::Connection& connection) -> kj::Promise<void> {
    auto access = tasks(connection);
    kj::Promise<void> following = kj::READY_NOW;
    if (batch->actions().size() > 1 && open->follow()) {  // nothing of a single one can be reported early
      auto follow = access.followRequest();
      follow.setFollower(kj::heap<FollowerServer<Open>>(open));
      following = follow.send().ignoreResult();
    }
    return send(access, batch->actions(), open->add(batch))
        .then([batch, open, who](Ended&& ended) {
          open->remove(batch);
          if (!ended) return batch->fail_rest(ended.error());
          if (ended->size() == batch->actions().size()) batch->add(std::move(*ended));
          batch->fail_rest(fail(ErrorCode::Internal, who + " did not answer for every action"));
        })
        .then([following = kj::mv(following)]() mutable { return kj::mv(following); });
  };
  const bool begun =
      channel_->start(timeout + kGrace, std::move(ask), [batch, open = open_](const Error& error) {
        open->remove(batch);
        batch->fail_rest(error);
      });
  if (!begun) batch->fail_rest(fail(ErrorCode::Unavailable, "the connection is closed"));
}

}  // namespace segue::control::detail
