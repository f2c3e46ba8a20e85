// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "disturbed_chain.hpp"
#include "test_network.hpp"

namespace segue::testing {

/// The same robot on a network: hosts a, b and c and the runtime have a station each, and meet over TCP with
/// certificates. Skipped, with the reason, where there can be no such network.
class NetworkTest : public DisturbedChainTest {
 protected:
  void SetUp() override;
  void TearDown() override;

  Surroundings surroundings_of(const std::string& host) override;
  [[nodiscard]] std::vector<std::string> runtime_launcher() const override;

  /// Host b has a small disk of its own for its state and its runtime folder. Before the hosts are made.
  void give_b_a_disk();
  void fill_disk() const;
  void empty_disk() const;

  /// The wall clocks of both hosts and of the runtime can be set. Before the hosts are made.
  void give_clocks();
  /// By so many seconds ahead of the computer's.
  void set_clock(const std::string& station, std::int64_t seconds) const;

  std::string say(const std::string& line) { return network_->say(line); }
  /// Switches. The switch is done, or says why not; then the robot runs what its controller says.
  bool try_switch(const std::string& controller);
  /// As expect_each_once_and_in_order(), and those that have not arrived are counted as dropped.
  void expect_all_accounted_for();

  std::unique_ptr<TestNetwork> network_;
  std::filesystem::path disk_;
  bool has_clocks_ = false;

 private:
  [[nodiscard]] std::vector<std::string> launcher(const std::string& station) const;
};

}  // namespace segue::testing
