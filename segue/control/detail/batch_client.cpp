// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/batch_client.hpp>
#include <segue/control/detail/deployment_wire.hpp>
#include <segue/host/batch_outcomes.hpp>

#include <map>
#include <utility>

namespace segue::control::detail {

namespace {

using Process = wire::DeploymentProcess;

constexpr auto kEncode = [](const auto& item, auto builder) { encode(item, builder); };

}  // namespace

struct BatchClient::Batch {
  Batch(std::vector<model::Action> asked, host::Completion completed)
      : actions(std::move(asked)), outcomes(actions.size(), std::move(completed)) {}

  void fail_rest(const Error& why) {
    outcomes.fail_rest([&](std::size_t) { return why; });
  }

  const std::vector<model::Action> actions;
  host::BatchOutcomes outcomes;
};

/// Those of which something may be told early, by their tickets. Lives in the loop.
class BatchClient::Followed {
 public:
  std::uint64_t add(const std::shared_ptr<Batch>& batch) {
    batches_.emplace(++last_, batch);
    return last_;
  }
  void remove(const std::shared_ptr<Batch>& batch) {
    std::erase_if(batches_, [&](const auto& item) { return item.second == batch; });
  }
  [[nodiscard]] std::shared_ptr<Batch> find(std::uint64_t ticket) const {
    const auto found = batches_.find(ticket);
    return found == batches_.end() ? nullptr : found->second;
  }
  /// True the first time.
  bool follow() { return !std::exchange(following_, true); }

 private:
  std::map<std::uint64_t, std::shared_ptr<Batch>> batches_;
  std::uint64_t last_ = 0;
  bool following_ = false;
};

namespace {

/// Takes what a process tells early; what is told of no batch, or twice, is dropped.
template <class Followed>
class FollowerServer final : public wire::BatchFollower::Server {
 public:
  explicit FollowerServer(std::shared_ptr<Followed> followed) : followed_(std::move(followed)) {}

  kj::Promise<void> told(ToldContext context) override {
    const auto params = context.getParams();
    if (const auto batch = followed_->find(params.getTicket())) {
      std::vector<host::Completed> ended;
      for (const auto one : params.getEnded())
        ended.push_back(decode(one));
      batch->outcomes.add(std::move(ended));
    }
    return kj::READY_NOW;
  }

 private:
  const std::shared_ptr<Followed> followed_;
};

}  // namespace

BatchClient::BatchClient(std::shared_ptr<Link> link)
    : link_(std::move(link)), followed_(std::make_shared<Followed>()) {}

void BatchClient::begin(std::vector<model::Action> actions, TimePoint deadline, host::Completion completed) {
  if (actions.empty()) return;
  const auto batch = std::make_shared<Batch>(std::move(actions), std::move(completed));
  const Duration left = time_left(deadline);
  auto send = [batch, left, followed = followed_,
               who = link_->who()](Link::Connection& connection) -> kj::Promise<void> {
    auto process = connection.as<Process>();
    auto request = process.performRequest();
    encode_list(batch->actions, request.initActions(count_of(batch->actions)), kEncode);
    request.setTimeout(left.count());
    if (auto fits = check_request(request.totalSize().wordCount); !fits) {
      batch->fail_rest(fits.error());
      return kj::READY_NOW;
    }
    kj::Promise<void> following = kj::READY_NOW;
    if (batch->actions.size() > 1) {  // of a single one there is nothing to tell early
      if (followed->follow()) {
        auto follow = process.followRequest();
        follow.setFollower(kj::heap<FollowerServer<Followed>>(followed));
        following = follow.send().ignoreResult();
      }
      request.setTicket(followed->add(batch));
    }
    return request.send()
        .then([batch, followed, who](auto&& response) {
          followed->remove(batch);
          if (response.hasError()) return batch->fail_rest(decode(response.getError()));
          std::vector<host::Completed> ended;
          for (const auto one : response.getEnded()) {
            const std::size_t place = ended.size();
            ended.push_back(decode(one));
            ended.back().index = place;
          }
          if (ended.size() == batch->actions.size()) batch->outcomes.add(std::move(ended));
          batch->fail_rest(fail(ErrorCode::Internal, who + " did not answer for everything asked"));
        })
        .then([following = kj::mv(following)]() mutable { return kj::mv(following); });
  };
  const bool begun = link_->start(left + kGrace, std::move(send), [batch, followed = followed_](Error error) {
    followed->remove(batch);
    batch->fail_rest(error);
  });
  if (!begun) batch->fail_rest(fail(ErrorCode::Unavailable, "the connection is closed"));
}

}  // namespace segue::control::detail
