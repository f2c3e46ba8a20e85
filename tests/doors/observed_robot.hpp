// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/control/server.hpp>
#include <segue/rpc_tls/authority.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime_service.hpp>
#include <segue/web/web_server.hpp>
#include <support/fake_deployment.hpp>
#include <support/fake_hosts.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::doors {

/// A robot that runs, somebody who commands it, and all doors through which other computers reach it and its
/// host: each over TLS, for the people olga (observe) and otto (operate). In its folder are what should lead
/// nowhere: links to files outside, and a FIFO.
class ObservedRobot {
 public:
  ObservedRobot();
  ~ObservedRobot();
  ObservedRobot(const ObservedRobot&) = delete;
  ObservedRobot& operator=(const ObservedRobot&) = delete;

  /// Stands in files of the computer outside of the robot's folder, and nowhere else.
  static constexpr std::string_view kSecret = "the-secret-of-this-computer";

  /// `kind`: "robot", "host" or "processes".
  [[nodiscard]] control::TcpEndpoint endpoint(std::string_view kind, const std::string& person) const;
  [[nodiscard]] std::uint16_t studio_port() const { return studio_->port(); }
  /// With all certificates.
  [[nodiscard]] const std::filesystem::path& enrolled() const { return enrolled_; }

  /// Names of files, tasks and so on, which a client learns from the robot.
  [[nodiscard]] std::vector<std::string> known_names() const;
  [[nodiscard]] std::uint64_t lease() const { return lease_->number(); }

  /// All that a client could have changed: what runs, its properties and what its tasks have received, who
  /// commands it, what was requested, the files and the processes.
  [[nodiscard]] std::string state();

 private:
  void make_files() const;
  void open_robot();
  void open_doors();
  [[nodiscard]] control::TcpPlace place() const;
  [[nodiscard]] std::string files() const;

  std::filesystem::path folder_;
  std::filesystem::path home_;  ///< of the robot
  std::filesystem::path enrolled_;
  std::optional<runtime::EmbeddedRobot> robot_;
  std::optional<runtime::RuntimeService> service_;
  std::unique_ptr<control::RobotLease> lease_;
  bool asked_to_end_ = false;
  std::optional<distributed::testing::Computer> host_;
  control::FakeProcesses processes_;
  std::unique_ptr<control::Server> robot_door_;
  std::unique_ptr<control::Server> host_door_;
  std::unique_ptr<control::Server> processes_door_;
  std::unique_ptr<web::Server> studio_;
};

}  // namespace segue::doors
