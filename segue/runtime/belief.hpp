// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>
#include <segue/model/network.hpp>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

namespace segue::runtime::detail {

/// What the host showed at some moment. Tasks may have changed by themselves since: Belief::adopt takes the
/// events after that moment into account.
struct Observation {
  model::Network network;
  std::uint64_t task_events = 0;  ///< how many had come before
  std::uint64_t adoptions = 0;    ///< how often the belief had been replaced by then
};

/// What is held to run.
struct Holding {
  model::Network controller;  ///< with the states that its tasks are in; its name is the robot's controller
  model::Network beside;      ///< what is kept ready for another, and what was left over
  /// The controller as it was requested; nothing where nobody requested what runs.
  std::optional<model::Network> wanted;
  [[nodiscard]] model::Network all() const;
  /// What should run: as requested, else as it does.
  [[nodiscard]] model::Network shall() const;
};

/// What was seen, as holding: what `controller` lacks of it stands beside.
Holding split(model::Network seen, const model::Network& controller, std::optional<model::Network> wanted);

/// The belief, kept true by what the host shows and by what tasks tell of themselves. Thread safe; calls
/// nothing but the host's observe(), without a lock.
class Belief {
 public:
  explicit Belief(const host::TaskHost& host) : host_(host) {}

  [[nodiscard]] Observation look() const;
  [[nodiscard]] Holding held() const;
  [[nodiscard]] model::Network controller() const;
  /// By a person, whatever runs: the next request starts from it.
  [[nodiscard]] bool is_given() const;

  /// Believes what was seen at a moment, and what tasks told since.
  void adopt(Holding seen, std::uint64_t task_events);
  /// The same, unless the belief was replaced since it was looked: false then.
  bool renew(Holding seen, const Observation& look);
  /// Believes what a person says.
  void adopt_given(model::Network network);
  void on_event(const host::TaskEvent& event);

  /// What runs, as a new request has to take it: named after the controller.
  [[nodiscard]] Observation starting_point() const;

 private:
  void replace(Holding seen, std::uint64_t task_events);

  const host::TaskHost& host_;
  mutable std::mutex mutex_;
  Holding held_;
  bool given_ = false;
  std::uint64_t task_events_ = 0;
  std::uint64_t adoptions_ = 0;
  /// For each task, the last state that it took by itself, and the number of that event.
  std::map<model::TaskId, std::pair<std::uint64_t, TaskState>> told_;
};

}  // namespace segue::runtime::detail
