// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>

#include "hosts_test.hpp"

namespace segue::testing {

/// A robot whose samples cross from host a to host b and back: a producer in process `front` of a, a relay in
/// process `work` of b, a consumer in process `back` of a. Its controllers share these, unless said
/// otherwise.
class ChainTest : public HostsTest {
 protected:
  /// Makes hosts a and b. Controllers:
  ///   plain    the chain
  ///   more     and tasks on both hosts, with connections in both directions
  ///   other    another relay on b, in another process, takes the place of the first
  ///   still    the chain with a stopped producer
  ///   near     a chain without host b
  /// `slow`: all stand-ins take that long for each step, so that transitions last.
  void make_chain(const std::vector<std::string>& optional_hosts = {}, const std::string& slow = {});
  /// A controller with the chain and more: lines of a network file.
  void add_to_chain(const std::string& name, const std::string& tasks = {},
                    const std::string& deployments = {}, const std::string& connections = {}) const;
  void start_chain(const std::string& controller, const std::vector<std::string>& more = {});

  /// What the consumer, or another one, has counted since it was started.
  struct Counted {
    std::uint64_t count = 0;
    std::uint64_t lost = 0;
    std::uint64_t late = 0;  ///< after a newer one
  };
  Counted counted(const std::string& consumer = "consumer");
  /// Waits until the consumer has got more samples.
  void wait_for_more();
  /// The same, and checks that none was ever missing.
  void expect_flow();
  /// Stops the producer, and waits until the consumer has everything that was written.
  void expect_all_arrived();
  /// Stops the producer. No sample has arrived twice, or after a later one. Returns how many have not
  /// arrived.
  std::uint64_t expect_each_once_and_in_order();
  /// The same, but samples may arrive late: where a switch gives the consumer another connection while
  /// packets are delayed or the computer is busy, what is on its way on the old one may be overtaken.
  std::uint64_t expect_each_once();
  struct Flow {
    std::uint64_t written = 0;
    std::uint64_t read = 0;
    std::uint64_t dropped = 0;
  };
  /// How often a task was updated since it was started.
  std::uint64_t updates(const std::string& task);
  /// What was written to a connection, delivered and dropped.
  Flow flow(const std::string& from, const std::string& to);
};

}  // namespace segue::testing
