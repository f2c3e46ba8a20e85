// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/tasks.capnp.h>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace segue::control::detail {

/// Gives the capability that is asked, in the loop of its channel.
using TasksOf = std::function<wire::TaskAccess::Client(RpcChannel::Connection&)>;

/// The batches of actions that were sent through one connection and have not ended. Answers are not trusted:
/// each action is reported once, whatever the other side answers. Thread safe.
class BatchClient {
 public:
  BatchClient(std::shared_ptr<RpcChannel> channel, TasksOf tasks);
  /// Reports actions that have not ended as Unavailable.
  ~BatchClient();
  BatchClient(const BatchClient&) = delete;
  BatchClient& operator=(const BatchClient&) = delete;

  /// Makes the request for a batch and sends it, in the loop.
  using Ended = Result<std::vector<task_host::Completed>>;
  using Send = std::function<kj::Promise<Ended>(
      wire::TaskAccess::Client access, const std::vector<model::Action>& actions, std::uint64_t ticket)>;

  /// Sends a batch of actions that do not depend on each other, and returns at once. `completed` gets each
  /// action once, in the loop of the channel; where the process does not answer, with an error.
  void begin(std::vector<model::Action> actions, TimePoint deadline, task_host::Completion completed);
  /// Sends a batch with the request that `send` makes. The answer may take as long as `timeout`.
  void begin(std::vector<model::Action> actions, Duration timeout, Send send,
             task_host::Completion completed);

  /// Sends `request`, which has actions, a timeout and a ticket, and whose results have what ended.
  template <class Request>
  static kj::Promise<Ended> send(Request request, const std::vector<model::Action>& actions, Duration timeout,
                                 std::uint64_t ticket);

 private:
  class Open;
  const std::shared_ptr<RpcChannel> channel_;
  const TasksOf tasks_;
  const std::shared_ptr<Open> open_;
};

template <class Request>
kj::Promise<BatchClient::Ended> BatchClient::send(Request request, const std::vector<model::Action>& actions,
                                                  Duration timeout, std::uint64_t ticket) {
  encode_list(actions, request.initActions(count_of(actions)),
              [](const auto& action, auto builder) { encode(action, builder); });
  request.setTimeout(timeout.count());
  if (auto fits = check_request(request.totalSize().wordCount); !fits) return Ended(fits.error());
  request.setTicket(ticket);
  return request.send().then([](auto&& response) -> Ended {
    if (response.hasError()) return decode(response.getError());
    std::vector<task_host::Completed> ended;
    for (const auto one : response.getEnded()) {
      const std::size_t place = ended.size();
      ended.push_back(decode(one));
      ended.back().index = place;
    }
    return ended;
  });
}

}  // namespace segue::control::detail
