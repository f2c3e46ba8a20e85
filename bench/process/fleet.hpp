// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../support/measure.hpp"

#include <segue/model/transition.hpp>
#include <segue/runtime/temporary_hosts.hpp>
#include <segue/task_host/task_host.hpp>

#include <memory>
#include <string>
#include <vector>

namespace bench {

/// The processes of a robot without a runtime: actions are passed directly to the task host. The destructor
/// ends all processes and removes the folder with their files and sockets.
class Fleet {
 public:
  /// `zygote`: processes are forked from one that has the component libraries loaded. Ends the program on
  /// failure.
  static std::unique_ptr<Fleet> open(bool zygote = false);
  /// The processes are on other hosts.
  static std::unique_ptr<Fleet> open_on(const segue::runtime::HostEntries& hosts);
  virtual ~Fleet() = default;
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;

  virtual segue::task_host::TaskHost& host() = 0;

  /// Executes actions concurrently; ends the program if one fails.
  void perform(const std::vector<segue::model::Action>& actions);
  /// A task of the bench components in a process, running.
  void run(const std::string& process, const std::vector<std::string>& tasks, const std::string& component);

 protected:
  Fleet() = default;
};

segue::model::Action on_task(segue::model::ActionKind kind, const std::string& task);
segue::model::Action on_process(segue::model::ActionKind kind, const segue::model::DeploymentKey& process);
/// A connection of the ports for samples of fixed size that transfers the last sample initially.
segue::model::Action on_connection(segue::model::ActionKind kind, const std::string& from,
                                   const std::string& to);
segue::model::Action place(const std::string& task, const std::string& component,
                           const segue::model::DeploymentKey& process);
/// A process on this computer.
segue::model::DeploymentKey here(const std::string& process);

}  // namespace bench
