// SPDX-License-Identifier: Apache-2.0
//
// Two network files, the second after a line "---": what validation lets pass, the solver solves, and the
// transition leads to the target.
#include "require.hpp"

#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>
#include <segue/solve/solve.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace segue::solve {
namespace {

using fuzz::require;
using model::Network;

std::optional<Network> network(std::string_view text) {
  Diagnostics diagnostics;
  return model::read_network(text, "f.yaml", diagnostics);
}

bool is_valid(const Network& network) {
  return !model::validate(network, {}, model::Depth::Structure).has_errors();
}

/// What runs may be in any state; validation knows targets.
bool is_valid_now(Network network) {
  for (model::Task& task : network.tasks)
    task.state = TaskState::Stopped;
  return is_valid(network);
}

/// Two claims on a device are found by validation against components, later than what the solver needs.
bool shares_devices(const Network& network) {
  std::set<std::string> devices;
  for (const model::Task& task : network.tasks) {
    for (const std::string& device : task.exclusive) {
      if (!devices.insert(device).second) return true;
    }
  }
  return false;
}

void solve(const Network& current, const Network& target, model::Order order) {
  const auto transition = diff(current, target, {}, {order});
  if (!transition) {
    require(transition.error().code == ErrorCode::Unsupported, to_string(transition.error()));
    return;
  }
  if (shares_devices(current) || shares_devices(target)) return;
  const auto found = predict(current, *transition, {});
  require(found.has_value(), found ? std::string() : to_string(found.error()));
  const auto differences = model::differences(*found, target, 1);
  require(differences.empty(), differences.empty() ? std::string() : differences.front());
  const auto rest = diff(*found, target, {}, {order});
  require(rest.has_value() && rest->actions.empty(), "nothing is left to do");
}

void solve(std::string_view text) {
  constexpr std::string_view kBetween = "\n---\n";
  const std::size_t end = text.find(kBetween);
  if (end == std::string_view::npos) return;
  const auto current = network(text.substr(0, end));
  const auto target = network(text.substr(end + kBetween.size()));
  if (!current || !target || !is_valid_now(*current) || !is_valid(*target)) return;
  solve(*current, *target, model::Order::Seamless);
  solve(*current, *target, model::Order::Paper);
}

}  // namespace
}  // namespace segue::solve

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  segue::solve::solve({reinterpret_cast<const char*>(data), size});
  return 0;
}
