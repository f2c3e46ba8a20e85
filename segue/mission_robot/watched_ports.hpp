// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/question.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <chrono>
#include <list>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// Follows the samples of some ports of a robot: each by one question at a time, which is answered when there
/// are samples. One thread uses this.
class WatchedPorts {
 public:
  /// The least time between two questions for a port.
  static constexpr Duration kBetweenSamples = std::chrono::milliseconds(10);
  /// How long a question waits; then it is asked again.
  static constexpr Duration kPatience = std::chrono::seconds(10);

  /// Answers ring `bell`.
  explicit WatchedPorts(std::shared_ptr<Bell> bell) : bell_(std::move(bell)) {}

  [[nodiscard]] bool follows(const Member& port) const { return find(port) != nullptr; }
  void follow(const Member& port, std::unique_ptr<PortSamples> samples);
  /// The ports of that task are not followed any more.
  void forget(std::string_view task);
  void forget(const Member& port);
  /// Takes in the answers that have come. The error of a port that cannot be read.
  Result<void> poll();
  /// Asks for samples of the ports that are not being asked of, where it is time.
  void ask();
  /// When ask() has something to do although the bell does not ring.
  [[nodiscard]] TimePoint next_question() const;

  /// The samples that the last poll() has taken in, oldest first.
  [[nodiscard]] std::span<const type::Value> fresh(const Member& port) const;

 private:
  struct One {
    One(Member member, std::unique_ptr<PortSamples> from, std::shared_ptr<Bell> bell)
        : port(std::move(member)), samples(std::move(from)), question(std::move(bell)) {}
    const Member port;
    const std::unique_ptr<PortSamples> samples;
    std::vector<type::Value> fresh{};
    TimePoint ask_at{};
    Question<std::vector<type::Value>> question;
  };

  [[nodiscard]] const One* find(const Member& port) const;

  const std::shared_ptr<Bell> bell_;
  std::list<One> ports_;
};

}  // namespace segue::mission
