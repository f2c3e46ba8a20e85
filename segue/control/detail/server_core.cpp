// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/control/detail/server_core.hpp>
#include <segue/control/detail/wire.hpp>

#include <array>

namespace segue::control::detail {

namespace {

/// In the order of Served.
constexpr std::array<std::string_view, 4> kNouns = {"the robot", "the deployment process",
                                                    "the process server", "the host"};
constexpr std::array<std::string_view, 4> kKinds = {kRobotKind, kDeploymentKind, kProcessesKind, kHostKind};

}  // namespace

Result<void> CallLimits::begin(ClientState& client) {
  if (client.calls >= kMostOfClient)
    return fail(ErrorCode::ResourceExhausted,
                "this client has too many calls in progress; wait for one to end");
  if (client.peer.role == Role::Observe) {
    const auto own = of_observers_.find(client.peer.name);
    if (own != of_observers_.end() && own->second >= kMostOfObserver)
      return fail(ErrorCode::ResourceExhausted,
                  "all connections of " + quote(client.peer.name) +
                      " together have too many calls in progress; wait for one to end");
    if (of_all_observers_ >= kMostOfAllObservers)
      return fail(ErrorCode::ResourceExhausted,
                  "those who only observe have too many calls in progress; try again");
    ++of_observers_[client.peer.name];
    ++of_all_observers_;
  }
  ++client.calls;
  return {};
}

void CallLimits::end(ClientState& client) {
  --client.calls;
  if (client.peer.role != Role::Observe) return;
  --of_all_observers_;
  const auto own = of_observers_.find(client.peer.name);
  if (--own->second == 0) of_observers_.erase(own);
}

std::string_view ServerCore::noun() const {
  return kNouns.at(served.index());
}

std::string_view ServerCore::kind() const {
  return kKinds.at(served.index());
}

}  // namespace segue::control::detail
