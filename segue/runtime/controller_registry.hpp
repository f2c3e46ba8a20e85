// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/halt.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/controller_conflict.hpp>
#include <segue/runtime/controller_set.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// The controllers that can be requested, and where they came from.
struct Definitions {
  Controllers controllers;
  std::set<model::NetworkName> loaded;  ///< those that came from files, which the next files replace
  std::optional<model::NetworkName> fallback;
  std::shared_ptr<const model::Halt> halt;  ///< null: the robot does not say how it comes to rest
  std::map<std::string, model::Transition> transitions;  ///< by name
  std::vector<LoadedFile> files;
};

/// Knows the controllers of a robot by name, with its fallback and its halt. They are replaced as a whole.
/// Thread safe; nothing blocks, and its mutex may be locked within others.
class ControllerRegistry {
 public:
  /// `host` and `catalog` must outlive this.
  ControllerRegistry(const task_host::TaskHost& host, const model::ComponentCatalog& catalog,
                     std::optional<model::NetworkName> fallback, const std::optional<model::Halt>& halt);

  /// Adds a controller that came from no file, or replaces the one of its name.
  void add(model::Network controller);
  /// Controllers of files, transitions, fallback, halt and files are those of `set` from now on. Returns what
  /// was before.
  Definitions replace(const ControllerSet& set);
  /// Puts definitions in force again that replace() has returned.
  void restore(Definitions before);

  /// The controller of that name; NotFound, with a similar name, where there is none.
  [[nodiscard]] Result<model::Network> find(const model::NetworkName& name) const;
  /// Nothing for the empty name, and where find() fails.
  [[nodiscard]] std::optional<model::Network> known(const model::NetworkName& name) const;
  /// As the host runs it: with what it adds to a network.
  [[nodiscard]] std::optional<model::Network> expanded(const model::NetworkName& name) const;
  /// Nothing: the robot has none, or it is not known.
  [[nodiscard]] std::optional<model::Network> fallback() const;
  [[nodiscard]] std::optional<model::NetworkName> fallback_name() const;
  [[nodiscard]] std::shared_ptr<const model::Halt> halt() const;
  [[nodiscard]] std::vector<model::NetworkName> names() const;
  [[nodiscard]] std::vector<LoadedFile> files() const;
  /// The transition of that name; NotFound, with a similar name, where there is none.
  [[nodiscard]] Result<model::Transition> transition(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> transitions() const;

  /// Findings about running the controllers of `set` here.
  [[nodiscard]] Diagnostics check(const ControllerSet& set) const;
  /// How the controllers would change with replace(set). `runs` names the running one.
  [[nodiscard]] std::vector<ControllerChange> compare(const ControllerSet& set,
                                                      const model::NetworkName& runs) const;
  /// How they differ from those of `before`.
  [[nodiscard]] std::vector<ControllerChange> changes_since(const Definitions& before,
                                                            const model::NetworkName& runs) const;
  /// For each two of these controllers what keeps them from running at once, and influences. NotFound.
  [[nodiscard]] Result<std::vector<ControllerConflict>> conflicts(
      const std::vector<model::NetworkName>& names) const;

  /// The controllers that a network is, by name, "" for none, and the one known controller that it is. Of a
  /// network without what the host adds.
  [[nodiscard]] model::NetworkName name_of(const model::Network& condensed) const;
  [[nodiscard]] std::optional<model::Network> running_controller(const model::Network& condensed) const;

 private:
  [[nodiscard]] Definitions with(const ControllerSet& set) const SEGUE_REQUIRES(mutex_);

  const task_host::TaskHost& host_;
  const model::ComponentCatalog& catalog_;
  mutable Mutex mutex_;
  Definitions now_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail
