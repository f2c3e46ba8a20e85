// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// What to do about a controller of which something failed by itself. Pure: no threads, no host.
namespace segue::runtime::detail {

/// Something that is not as the controller wants it.
struct Ailment {
  std::variant<model::TaskId, model::DeploymentKey> subject;
  model::FailurePolicy policy = model::FailurePolicy::Report;
  std::string symptom;         ///< "is in exception"
  bool needs_process = false;  ///< only a new process helps

  [[nodiscard]] std::string name() const;  ///< "task 'slam'"
};

/// Tasks and processes of `wanted` that `observed` lacks or has in another state, tasks whose connections are
/// missing; each once, processes that are gone instead of their tasks. Properties do not count: people set
/// them.
std::vector<Ailment> ailments(const model::Network& wanted, const model::Network& observed,
                              model::FailurePolicy otherwise);

/// Decides when what is tried, and when it is given up. Not thread safe.
class Watch {
 public:
  explicit Watch(model::RestartPolicy restart) : restart_(restart) {}

  struct Verdict {
    std::vector<Ailment> repair;    ///< now
    std::vector<Ailment> given_up;  ///< from now on
    bool fallback = false;          ///< now
    [[nodiscard]] bool empty() const { return repair.empty() && given_up.empty() && !fallback; }
  };
  /// What ails now, all of it. What is to be repaired counts as tried.
  Verdict judge(const std::vector<Ailment>& ailing, TimePoint now);
  /// When there is something to try next; nothing: nothing waits.
  [[nodiscard]] std::optional<TimePoint> next() const;
  /// How often the subject was tried to be repaired.
  [[nodiscard]] int attempts(const Ailment& ailment) const;
  /// Another controller runs: all is forgotten.
  void reset() { cases_.clear(); }

 private:
  struct Case {
    int attempts = 0;
    TimePoint next;
    TimePoint last_seen;
    bool given_up = false;
  };

  void close_healed(TimePoint now);
  void consider(const Ailment& ailment, TimePoint now, Verdict& verdict);
  [[nodiscard]] Duration backoff(int attempts) const;

  const model::RestartPolicy restart_;
  std::map<std::string, Case> cases_;  ///< by name
};

}  // namespace segue::runtime::detail
