// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/process_server/process_service.hpp>

#include <memory>
#include <string>

namespace segue::process_server {

/// Lets several users share one ProcessService: each has a service of its own, with a listener of its own.
/// Thread safe.
class ProcessHub {
 public:
  /// `processes` must outlive this and all that for_robot() and for_all() gave; its listener belongs to this.
  explicit ProcessHub(ProcessService& processes);
  ~ProcessHub();
  ProcessHub(const ProcessHub&) = delete;
  ProcessHub& operator=(const ProcessHub&) = delete;

  /// Its listener hears of the processes of that robot only.
  std::unique_ptr<ProcessService> for_robot(std::string robot);
  /// Its listener hears of all processes.
  std::unique_ptr<ProcessService> for_all();

 private:
  class Share;
  struct Listeners;
  ProcessService& processes_;
  const std::shared_ptr<Listeners> listeners_;
};

}  // namespace segue::process_server
