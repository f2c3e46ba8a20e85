// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// The tasks and connections of a robot, in which chains are looked for.
namespace segue::cli {

struct ChainPort {
  std::string task;
  std::string port;  ///< empty: any of the task's
  friend auto operator<=>(const ChainPort&, const ChainPort&) = default;
};
std::string to_string(const ChainPort& port);

struct ChainConnection {
  ChainPort from;
  ChainPort to;
  friend auto operator<=>(const ChainConnection&, const ChainConnection&) = default;
};
std::string to_string(const ChainConnection& connection);

struct ChainTask {
  std::string component;
  std::string host;
  std::string process;  ///< empty: the runtime's own
};

class ChainNetwork {
 public:
  /// The network that runs: from the JSON of `status`.
  explicit ChainNetwork(const type::Value& status);
  /// Goes on to the network after a transition: from the JSON of `diff`.
  void apply(const type::Value& transition);

  /// nullptr where there is no such task.
  [[nodiscard]] const ChainTask* task(const std::string& id) const;
  [[nodiscard]] const std::map<std::string, ChainTask>& tasks() const { return tasks_; }
  /// "guard" or "guard.scan"; NotFound, with a similar task, where there is no such task.
  [[nodiscard]] Result<ChainPort> find(std::string_view text) const;

  static constexpr std::size_t kMostChains = 16;
  /// The ways from one task or port to another that pass no task twice, the shortest first, at most
  /// kMostChains. From a task to itself: its loops. NotFound where there is none.
  [[nodiscard]] Result<std::vector<std::vector<ChainConnection>>> chains(const ChainPort& from,
                                                                         const ChainPort& to) const;

 private:
  [[nodiscard]] ChainPort port_in(const type::Value& map, std::string_view key) const;

  std::map<std::string, ChainTask> tasks_;
  std::set<ChainConnection> connections_;
};

}  // namespace segue::cli
