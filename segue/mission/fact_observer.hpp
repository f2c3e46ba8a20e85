// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/robot_look.hpp>
#include <segue/mission/world.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace segue::mission {

/// The observed facts of a mission (ObservedFact), as the robot shows them. Thread safe.
class FactObserver {
 public:
  struct Options {
    Duration period = std::chrono::milliseconds(20);  ///< how often the robot is looked at
    Duration answer_deadline = std::chrono::seconds(1);
  };
  /// Begins to look, in a thread of its own.
  FactObserver(std::shared_ptr<CommandedRobot> robot, std::vector<ObservedFact> facts, Options options);
  /// Those that watch are not called any more.
  ~FactObserver();
  FactObserver(const FactObserver&) = delete;
  FactObserver& operator=(const FactObserver&) = delete;

  /// A run begins with these facts: they count for those that could not be observed yet.
  void begin(const World::Facts& facts);
  /// Looks at the robot now: the first of these facts that is not as it says. Blocks until the robot has
  /// answered; where a port has just been opened, until its first sample comes, for the fact's settling time
  /// at most.
  std::optional<GroundFact> first_false(std::span<const GroundFact> facts);
  /// Whether the fact is so, as of a look now; nothing where it cannot be observed.
  std::optional<bool> observed(std::string_view fact);
  /// An action has made these facts true or false: that counts for those that cannot be observed.
  void assume(std::span<const GroundFact> effects);
  /// How long an effect on that fact may take to show.
  [[nodiscard]] Duration settle(std::string_view fact) const;

  /// Calls `look` on the thread of this, once in each period, until it answers false.
  void watch(std::function<bool()> look);

 private:
  struct Entry {
    ObservedFact declared;
    bool value = false;  ///< as observed last
    bool seen = false;   ///< it could be observed at least once
    std::optional<PortFeed> feed{};
    TimePoint opened{};
    std::uint64_t updates =
        0;  ///< of the task whose port is followed; fewer are those of another incarnation
  };

  void work(const std::stop_token& end);
  std::optional<bool> look(Entry& entry);
  std::optional<bool> look(Entry& entry, const TaskReaches& when);
  std::optional<bool> look(Entry& entry, const SampleShows& when);
  std::optional<bool> look(Entry& entry, const OperationAnswers& when);
  bool value_now(Entry& entry);

  const std::shared_ptr<CommandedRobot> robot_;
  const Options options_;
  std::mutex looking_;  ///< protects `entries_`; held while the robot is asked
  std::map<std::string, Entry, std::less<>> entries_;
  std::mutex mutex_;  ///< protects `watches_`
  std::vector<std::function<bool()>> watches_;
  std::jthread thread_;
};

}  // namespace segue::mission
