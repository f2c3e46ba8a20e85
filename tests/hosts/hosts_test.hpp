// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "../system/system_test.hpp"
#include "logged_process.hpp"
#include "test_host.hpp"

/// Robots on several hosts, through the command line, with real daemons and deployments. Several daemons on
/// this computer, each with its own folders, act as several hosts.
namespace segue::testing {

/// Kills all processes of a test when the process of the test ends, however that happens.
class Guardian {
 public:
  /// Before other threads are started: `folder` is what the runtime folders of all processes begin with.
  explicit Guardian(std::string folder);
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

 private:
  pid_t pid_ = -1;
  int end_ = -1;
};

class HostsTest : public SystemTest {
 protected:
  void SetUp() override;
  /// Stops the robot and checks that no host has a process of it left.
  void TearDown() override;

  /// Where a host is, and what starts the robot's runtime; by default just this computer.
  virtual Surroundings surroundings_of(const std::string& host);
  [[nodiscard]] virtual std::vector<std::string> runtime_launcher() const { return {}; }

  /// Starts the daemons.
  void make_hosts(const std::vector<std::string>& names);
  TestHost& host(const std::string& name) { return *hosts_.at(name); }
  /// robot/robot.yaml with these hosts and further lines.
  void write_robot(const std::string& more, const std::vector<std::string>& optional_hosts = {}) const;

  /// `segue run`, until it is ready. A second runtime has another folder for its socket.
  std::unique_ptr<LoggedProcess> run_robot(const std::string& runtime_folder,
                                           const std::vector<std::string>& options) const;
  void start_robot(const std::vector<std::string>& options = {});
  void stop_robot();
  void kill_runtime();

  /// Switches and expects the outcome ("done").
  type::Value switch_to(const std::string& controller, const std::string& outcome = "done");
  /// Switches until the robot is as the controller says; the first attempts may fail.
  [[nodiscard]] bool recover_to(const std::string& controller);
  type::Value status() { return json({"status"}); }
  /// What is wrong if exactly this network should run: what the runtime says of tasks, states, places and
  /// connections, and the processes that the hosts have. Hosts that are `lost` are not looked at.
  [[nodiscard]] std::string what_is_wrong(const model::Network& network);
  /// The same, once nothing is wrong any more or time is up.
  [[nodiscard]] std::string what_stays_wrong(const model::Network& network);
  [[nodiscard]] model::Network network(const std::string& name) const;
  /// A host as the runtime sees it.
  type::Value host_status(const std::string& name);
  [[nodiscard]] bool wait_until_reachable(const std::string& host, bool reachable);
  /// The number of the latest event.
  std::int64_t last_event();
  /// Waits for an event after that number whose kind is this and whose text contains `words`.
  void expect_event(const std::string& kind, const std::string& words, std::int64_t after = 0);
  /// All deployment processes of all hosts: "a/work" and its pid.
  [[nodiscard]] std::map<std::string, pid_t> all_deployments() const;

  std::string robot_name_;
  std::map<std::string, std::unique_ptr<TestHost>> hosts_;
  std::unique_ptr<LoggedProcess> runtime_;

 private:
  std::unique_ptr<Guardian> guardian_;
  int runs_ = 0;
};

}  // namespace segue::testing
