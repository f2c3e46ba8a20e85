// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/message_reader.hpp"
#include "../participant/participant.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ros2 {

/// Listens to what a node says of its parameters (/parameter_events), since others can change them, too. Any
/// thread.
class ParameterWatch {
 public:
  struct Difference {
    std::string name;
    segue::type::Value expected;
    segue::type::Value now;  ///< null: it has been deleted
  };

  /// `node`: "/robot/talker". Fails as Participant::make_reader().
  static segue::Result<std::unique_ptr<ParameterWatch>> make(const std::shared_ptr<Participant>& participant,
                                                             const std::string& node);
  /// The values that they have been set to: a request as parameters_request() makes it.
  void expect(const segue::type::Value& request);
  /// Those that have another value now, by name. What has not been expected does not count.
  [[nodiscard]] std::vector<Difference> differences() const;
  [[nodiscard]] segue::ros2::Gid gid() const { return reader_.gid(); }

 private:
  ParameterWatch(std::string node, segue::ros2::MessageCodec event);
  void take(std::span<const std::byte> message);

  const std::string node_;
  const segue::ros2::MessageCodec event_;
  mutable segue::Mutex mutex_;
  std::map<std::string, segue::type::Value> expected_ SEGUE_GUARDED_BY(mutex_);
  std::map<std::string, segue::type::Value> said_ SEGUE_GUARDED_BY(mutex_);  ///< by the node, of those last
  MessageReader reader_;                                                     ///< last: it calls take()
};

}  // namespace ros2
