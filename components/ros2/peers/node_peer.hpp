// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "service_peer.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/type/value.hpp>

#include <support/temporary_files.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace ros2::testing {

/// A managed node "/lidar" of ROS 2, active, that publishes "/scan" of a type that is not built in
/// (lidar_msgs/msg/Sweep), and has parameters; it answers in a thread of its own.
class NodePeer {
 public:
  enum class Fault {
    None,
    HidesParameters,  ///< never answers list_parameters
    LosesParameters,  ///< answers get_parameters with too few
    TellsAnotherType
  };

  explicit NodePeer(const std::function<std::unique_ptr<Peer>()>& make_peer, Fault fault = Fault::None);
  ~NodePeer();
  NodePeer(const NodePeer&) = delete;
  NodePeer& operator=(const NodePeer&) = delete;

  /// The hash of the type of "/scan".
  const std::string& hash() const { return hash_; }
  /// The parameters that it got last (rcl_interfaces/srv/SetParametersAtomically), a map.
  segue::type::Value got_parameters();
  int state() const { return state_; }

 private:
  using Value = segue::type::Value;
  void serve(Fault fault);
  Value set_parameters(const Value& request);
  Value type_response(Fault fault);

  segue::testing::TemporaryFiles files_;
  segue::ros2::InterfaceLibrary library_;
  std::string hash_;
  std::unique_ptr<Peer> topic_;
  std::atomic<int> state_{3};
  segue::Mutex mutex_;
  Value got_ SEGUE_GUARDED_BY(mutex_);
  std::optional<ServicePeer> services_;  ///< the last, since its thread uses all others
};

}  // namespace ros2::testing
