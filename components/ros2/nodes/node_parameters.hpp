// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"
#include "parameter_client.hpp"
#include "parameter_watch.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace ros2 {

/// The parameters of a node as its task has them: sets them, and notices that others change them. Thread of
/// the task; cancel() in any.
class NodeParameters {
 public:
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

  /// After open(). Fails as ParameterClient::set().
  segue::Result<void> set(segue::TimePoint deadline);
  /// The node has been started with those that are wanted.
  void were_given() { expect(); }
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
  void expect();

  segue::type::Value request_;
  std::unique_ptr<ParameterClient> client_;
  std::unique_ptr<ParameterWatch> watch_;
  std::set<std::string> changed_before_;  ///< at the last call of newly_changed()
  std::set<std::string> said_;            ///< by it
};

}  // namespace ros2
