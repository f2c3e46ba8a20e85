// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// Connections between hosts. On each host a process, the gateway, holds tasks that send samples to other
/// hosts and receive them (components/gateway). A connection between hosts is then a connection of the writer
/// with a sender, and one of a receiver on the other host with the reader: tasks and connections like all
/// others, which transitions create and remove like all others.
namespace segue::distributed {

/// The process of each host that holds senders and receivers.
inline const model::ProcessName kGatewayProcess{"segue_gateway"};
/// The component library of senders and receivers, which only that process loads.
inline constexpr const char* kGatewayLibrary = "segue_components_gateway";

/// The interfaces of senders and receivers.
std::vector<model::ComponentModel> gateway_models();

struct GatewaySettings {
  std::string robot;                 ///< begins the names of topics
  int domain = 0;                    ///< DDS domain
  std::vector<model::HostName> own;  ///< further names of the runtime's own computer
  /// The addresses at which hosts exchange samples; without one, Cyclone DDS chooses. Addresses of other
  /// hosts are not properties of tasks, so tasks stay as they are where the robot gets another host or the
  /// runtime another computer.
  std::map<model::HostName, std::string> addresses;
};

/// The type of samples, and the component library that defines it. Both empty: samples carry no value.
struct SampleType {
  std::string type;
  std::string library;
};
using TypeOf = std::function<SampleType(const model::Task& writer, const std::string& port)>;

/// Replaces connections between hosts. A network on several hosts gets a gateway on each of them, even if
/// none of its connections needs one, since others will. One sender serves all readers of a port with the
/// same policy, and one receiver those on its host. Linear in the size of the network.
model::Network with_gateways(model::Network network, const GatewaySettings& settings, const TypeOf& type_of);

/// The network without gateways: the inverse of with_gateways(). A connection between hosts exists where both
/// of its halves do.
model::Network without_gateways(model::Network network);

/// Whether a task is a sender or receiver, by its id, which no file can contain.
bool is_link_task(const model::TaskId& task);
/// The sender of a receiver; nothing for other tasks.
std::optional<model::TaskId> sender_of(const model::TaskId& receiver);

}  // namespace segue::distributed
