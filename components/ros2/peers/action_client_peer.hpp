// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "count_messages.hpp"
#include "peer.hpp"

#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ros2::testing {

/// A client of the action "/count" (count_messages.hpp), which asks what a test tells it to. What it waits
/// for comes soon, or the test fails.
class ActionClientPeer {
 public:
  /// As in messages: {uuid: [...]}.
  using Id = segue::type::Value;
  struct Canceled {
    int code = -1;
    std::vector<Id> goals;
  };
  struct Result {
    Result(int how, std::int64_t far) : status(how), reached(far) {}
    int status;
    std::int64_t reached;
    friend bool operator==(const Result&, const Result&) = default;
  };

  ActionClientPeer(const std::function<std::unique_ptr<Peer>()>& make_peer,
                   const std::filesystem::path& folder);

  /// Whether it has found one server, with all of its parts.
  bool is_served();
  /// Sends a goal; whether it is accepted.
  bool send(const Id& id, int target);
  /// `seconds`: until when the goals that it is about were accepted; 0: it says no time.
  Canceled cancel(const Id& id, int seconds = 0);
  Canceled cancel_all() { return cancel(goal_id_of_byte(0)); }
  /// The request for the result of a goal.
  std::int64_t ask_for_result(const Id& id);
  Result result(std::int64_t request);
  Result result(const Id& id) { return result(ask_for_result(id)); }
  /// Results that have come to requests, without waiting.
  std::size_t results() { return results_.take().size(); }
  /// Of that goal, all that has come.
  std::vector<int> feedback(const Id& id);
  /// The number in action_msgs/msg/GoalStatus that the latest status has for the goal; 0: none.
  int status(const Id& id);
  /// Sends bytes to the services "send_goal", "cancel_goal" and "get_result".
  void send_to_all(const Bytes& request);
  [[nodiscard]] Bytes goal_request(const Id& id, int target) const;
  /// Sends such a request without waiting for the answer.
  void send_goal_bytes(const Bytes& request) { goals_.peer->ask(request); }
  bool has_answer_to_goal() { return !goals_.take().empty(); }

 private:
  /// One of the services.
  struct Service {
    std::unique_ptr<Peer> peer;
    std::map<std::int64_t, Bytes> responses{};

    const std::map<std::int64_t, Bytes>& take();
    Bytes response_to(std::int64_t request);
  };

  const ActionCodecs codecs_;
  Service goals_;    ///< and feedback
  Service cancels_;  ///< and status
  Service results_;
  std::vector<segue::type::Value> feedback_;
  std::optional<segue::type::Value> status_;
};

}  // namespace ros2::testing
