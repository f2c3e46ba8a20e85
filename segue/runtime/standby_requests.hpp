// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/controller_registry.hpp>
#include <segue/runtime/event_log.hpp>
#include <segue/runtime/leases.hpp>
#include <segue/runtime/look_ahead.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <future>
#include <optional>
#include <vector>

namespace segue::runtime::detail {

/// The controllers that somebody wants to be kept on standby, and how far they are. Thread safe; nothing but
/// plan() blocks.
class StandbyRequests {
 public:
  struct Sources {
    const task_host::TaskHost& host;
    const model::ComponentCatalog& catalog;
    const Leases& leases;
    const ControllerRegistry& controllers;
    EventLog& log;
  };
  /// `sources` and the objects that they refer to must outlive this.
  StandbyRequests(const Sources& sources, const model::LookAhead& budget)
      : sources_(sources), budget_(budget) {}

  /// Keeps these controllers prepared from now on, the likeliest first; look-ahead is due. Nothing where
  /// nothing is done with that lease any more.
  std::optional<std::future<std::vector<Readiness>>> request(std::vector<model::NetworkName> wanted,
                                                             std::uint64_t lease);
  /// As much of them as the budget permits beside `controller`, and the halt's controller. Asks the host how
  /// much memory processes use.
  [[nodiscard]] LookAheadPlan plan(const model::Network& controller) const;
  /// Answers who waits, and logs how far each is.
  void answer(std::vector<Readiness> readiness);
  [[nodiscard]] std::vector<Readiness> readiness() const;

  /// Controllers that are prepared may have to change: look-ahead is due where there is anything to prepare,
  /// or to answer.
  void look_again();
  /// Whether it was due; it is not from now on.
  [[nodiscard]] bool take_due();
  /// The runtime ends; who waits is told so.
  void end();

 private:
  [[nodiscard]] std::vector<PrepareRequest> known_requests(const model::Network& controller) const;

  const Sources sources_;
  const model::LookAhead budget_;
  mutable Mutex mutex_;  ///< protects all below; not held while the host is asked
  std::vector<model::NetworkName> wanted_ SEGUE_GUARDED_BY(mutex_);
  /// With which these were requested and end; 0: none.
  std::uint64_t lease_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::optional<std::promise<std::vector<Readiness>>> waiting_ SEGUE_GUARDED_BY(mutex_);
  std::vector<Readiness> readiness_ SEGUE_GUARDED_BY(mutex_);
  bool due_ SEGUE_GUARDED_BY(mutex_) = false;
};

}  // namespace segue::runtime::detail
