// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"
#include "found_parameters.hpp"
#include "parameter_client.hpp"
#include "parameter_watch.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace ros2 {

/// The parameters of a node as its task has them: sets them, gives those that it sets no longer the values
/// that they had before, and notices that others change them. Thread of the task; cancel() in any.
class NodeParameters {
 public:
  NodeParameters() = default;
  ~NodeParameters() { close(); }
  NodeParameters(const NodeParameters&) = delete;
  NodeParameters& operator=(const NodeParameters&) = delete;

  /// Those that the node is to have from the next set() or start on, a map. InvalidArgument where no
  /// parameter can have one of the values; the former ones are kept then.
  segue::Result<void> want(const segue::type::Value& parameters);
  /// Whether none are wanted.
  [[nodiscard]] bool empty() const;
  /// Those that are wanted, as parameters_request() makes it.
  [[nodiscard]] const segue::type::Value& request() const { return request_; }

  /// Where some are wanted: from here on it is noticed that others change them. Fails as
  /// ParameterWatch::make().
  segue::Result<void> watch(const std::shared_ptr<Participant>& participant, const std::string& node);
  /// From here on set() sets them. Fails as ParameterClient::make().
  segue::Result<void> open(const std::shared_ptr<Participant>& participant, const std::string& node);
  /// Whether set() sets them.
  [[nodiscard]] bool is_open() const { return client_ != nullptr; }
  /// Whether open() and watch() have nothing left to do.
  [[nodiscard]] bool is_complete() const { return is_open() && (watch_ != nullptr || empty()); }
  void close();

  /// After open(): sets those that are wanted. One that it has set before, and that is not wanted any more,
  /// gets the value that it had before that, unless another task sets it, too, or somebody else has changed
  /// it since. All or nothing. Fails as ParameterClient does.
  segue::Result<void> set(segue::TimePoint deadline);
  /// set() where none are wanted. Does nothing where none were set.
  segue::Result<void> give_back(segue::TimePoint deadline);
  /// Those that the last set() has left as they were, since it is not known which value they had before: the
  /// node was started with them, or did not tell.
  [[nodiscard]] const std::vector<std::string>& kept() const { return kept_; }
  /// The node has been started with those that are wanted.
  void were_given();
  /// Any thread, after open(): calls in progress and later ones end at once.
  void cancel() { client_->cancel(); }

  /// Those that others have changed: "rate is 20, not 10".
  [[nodiscard]] std::vector<std::string> changed() const;
  /// Each of them once, and not before the second call that finds it: it may be on its way still.
  std::vector<std::string> newly_changed();

  /// Adds those endpoints that are needed for all this.
  void add_gids(std::vector<segue::ros2::Gid>& publishers,
                std::vector<segue::ros2::Gid>& subscriptions) const;

 private:
  /// Messages of parameters by their names.
  using Values = std::map<std::string, segue::type::Value>;

  [[nodiscard]] Values wanted() const;
  [[nodiscard]] FoundParameters::Name named(const std::string& parameter) const { return {node_, parameter}; }
  void let_go(const std::string& parameter);
  /// Notes the values that those had which are set for the first time.
  segue::Result<void> note_found(const Values& wanted, segue::TimePoint deadline);
  /// The former values of those that are not wanted any more, as far as they are to get them.
  segue::Result<Values> former(const Values& wanted, segue::TimePoint deadline);
  segue::Result<void> set(const Values& wanted, segue::TimePoint deadline);
  void have_set(Values wanted);

  std::string node_;
  segue::type::Value request_;
  Values set_;  ///< by this task, or when the node was started
  std::vector<std::string> kept_;
  std::unique_ptr<ParameterClient> client_;
  std::unique_ptr<ParameterWatch> watch_;
  std::set<std::string> changed_before_;  ///< at the last call of newly_changed()
  std::set<std::string> said_;            ///< by it
};

}  // namespace ros2
