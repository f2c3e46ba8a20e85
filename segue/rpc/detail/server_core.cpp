// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc/detail/server_core.hpp>

namespace segue::control::detail {

Result<void> CallLimits::begin(ClientState& client, CallLane lane) {
  const bool urgent = lane == CallLane::Urgent;
  std::size_t& calls = urgent ? client.urgent_calls : client.calls;
  if (calls >= (urgent ? kMostUrgentOfClient : kMostOfClient))
    return fail(ErrorCode::ResourceExhausted,
                "this client has too many calls in progress; wait for one to end");
  if (!urgent && client.peer.role == Role::Observe) {
    if (auto begun = begin_of_observer(client.peer.name); !begun) return begun;
  }
  ++calls;
  return {};
}

void CallLimits::end(ClientState& client, CallLane lane) {
  const bool urgent = lane == CallLane::Urgent;
  --(urgent ? client.urgent_calls : client.calls);
  if (!urgent && client.peer.role == Role::Observe) end_of_observer(client.peer.name);
}

Result<void> CallLimits::begin_of_observer(const std::string& name) {
  const auto own = of_observers_.find(name);
  if (own != of_observers_.end() && own->second >= kMostOfObserver)
    return fail(ErrorCode::ResourceExhausted,
                "all connections of " + quote(name) +
                    " together have too many calls in progress; wait for one to end");
  if (of_all_observers_ >= kMostOfAllObservers)
    return fail(ErrorCode::ResourceExhausted,
                "those who only observe have too many calls in progress; try again");
  ++of_observers_[name];
  ++of_all_observers_;
  return {};
}

void CallLimits::end_of_observer(const std::string& name) {
  --of_all_observers_;
  const auto own = of_observers_.find(name);
  if (--own->second == 0) of_observers_.erase(own);
}

}  // namespace segue::control::detail
