// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "service_peer.hpp"

#include <segue/ros2/interface_library.hpp>

#include <support/temporary_files.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ros2::testing {

/// The response of a node to GetTypeDescription, without texts of files.
segue::type::Value type_response_of(segue::ros2::InterfaceLibrary& library, const std::string& type);

/// A node "/dock" of ROS 2 with a service "/dock/ask" (dock_msgs/srv/Ask) and an action "/dock/run"
/// (dock_msgs/action/Run) that are not built in, which tells types in the way of rcl: by the hashes of those
/// of its publishers, its services and its action.
class TypedPeer {
 public:
  enum class Release {
    Jazzy,              ///< tells the hashes of topics, requests and responses
    JazzyIntrospected,  ///< and publishes the events of its service
    Lyrical,            ///< tells the hashes of services, too
    Wrong               ///< the hash of the response of its service is not that of what it tells
  };

  TypedPeer(const std::function<std::unique_ptr<Peer>()>& make_peer, Release release);
  ~TypedPeer();
  TypedPeer(const TypedPeer&) = delete;
  TypedPeer& operator=(const TypedPeer&) = delete;

 private:
  using Value = segue::type::Value;
  std::string hash(const std::string& type);
  void serve(const std::string& name, const std::string& type, Release release);
  void publish(const std::function<std::unique_ptr<Peer>()>& make_peer, const std::string& topic,
               const std::string& type);
  Value tell(const std::string& hash);

  segue::testing::TemporaryFiles files_;
  segue::ros2::InterfaceLibrary library_;
  std::map<std::string, std::string> registered_;  ///< types by their hashes
  std::vector<std::unique_ptr<Peer>> topics_;
  std::optional<ServicePeer> services_;  ///< the last, since its thread uses all others
};

}  // namespace ros2::testing
