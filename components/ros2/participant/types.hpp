// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ros2 {

/// Which process a node is in, where Segue starts it. Empty: it runs already.
struct ProcessSettings {
  std::string installation;  ///< its name in this computer's file of installations; empty: the only one
  std::string package;
  std::string executable;  ///< a program of the package, which is this node; or else:
  std::string component;   ///< a plugin of the package ("nav2_planner::PlannerServer") that is loaded into:
  std::string container;   ///< "/nav2_container", which is started with the first of its nodes
  std::string container_program =
      "rclcpp_components/component_container_isolated";  ///< empty: the container runs already
  std::vector<std::string> remappings;                   ///< "scan:=/front/scan"
  std::vector<std::string> arguments;                    ///< of the program

  [[nodiscard]] bool is_empty() const { return package.empty(); }
  friend bool operator==(const ProcessSettings&, const ProcessSettings&) = default;
};

SEGUE_TYPE(ProcessSettings, installation, package, executable, component, container, container_program,
           remappings, arguments)

/// A topic and the quality of service with which this side publishes it or subscribes to it.
struct TopicSettings {
  std::string topic;  ///< "/scan"
  std::string type;   ///< its interface: "sensor_msgs/msg/LaserScan"
  std::string reliability = "reliable";
  std::string durability = "volatile";
  std::uint32_t depth = 10;
  std::chrono::nanoseconds deadline{0};
  std::chrono::nanoseconds lifespan{0};  ///< of a publisher
  std::string liveliness = "automatic";
  std::chrono::nanoseconds lease{0};
};

SEGUE_TYPE(TopicSettings, topic, type, reliability, durability, depth, deadline, lifespan, liveliness, lease)

/// All counted since the task was configured.
struct PublisherStatistics {
  std::uint64_t sent = 0;  ///< samples that Fast DDS took
  std::uint64_t refused =
      0;  ///< samples that were not sent: a bound of the message is exceeded, or subscriptions are slow
  std::uint64_t bytes = 0;       ///< of those sent, as CDR
  std::uint64_t missed = 0;      ///< deadlines that were missed, and losses of liveliness
  std::uint32_t matched = 0;     ///< subscriptions now
  std::uint32_t mismatched = 0;  ///< subscriptions now that have the topic but get nothing from here
};

/// All counted since the task was configured.
struct SubscriptionStatistics {
  std::uint64_t received = 0;    ///< samples that arrived whole, and were for this task
  std::uint64_t early = 0;       ///< samples that came before the task ran and its connections had begun
  std::uint64_t refused = 0;     ///< of those received: a connection of `out` had no room
  std::uint64_t lost = 0;        ///< samples that were overwritten before they arrived, as Fast DDS tells
  std::uint64_t corrupt = 0;     ///< messages that are not samples of the type
  std::uint64_t foreign = 0;     ///< samples that are not of the node whose port this is
  std::uint64_t bytes = 0;       ///< of those received, as CDR
  std::uint64_t missed = 0;      ///< deadlines that were missed, and losses of liveliness
  std::uint32_t matched = 0;     ///< publishers now
  std::uint32_t mismatched = 0;  ///< publishers now that have the topic but from which nothing comes
};

/// A port of a node's task that carries what the node publishes.
struct PublishedStatistics {
  std::string port;
  std::string topic;
  SubscriptionStatistics counts;
};

/// A port of a node's task that carries what the node subscribes to.
struct SubscribedStatistics {
  std::string port;
  std::string topic;
  PublisherStatistics counts;
};

struct NodeStatistics {
  std::vector<PublishedStatistics> publishes;
  std::vector<SubscribedStatistics> subscribes;
};

/// All counted since the task was configured.
struct ActionStatistics {
  std::uint64_t goals = 0;     ///< that were sent, or were to be
  std::uint64_t feedback = 0;  ///< of goals that were under way
  std::uint64_t corrupt = 0;   ///< messages that are not feedback or results of the action
  std::uint32_t servers = 0;   ///< now
};

/// All counted since the task was configured.
struct ActionServerStatistics {
  std::uint64_t goals = 0;     ///< that were accepted
  std::uint64_t rejected = 0;  ///< goals that were not
  std::uint64_t feedback = 0;  ///< that was sent
  std::uint64_t refused = 0;   ///< requests when too many waited
  std::uint64_t corrupt = 0;   ///< requests that are no such messages
  std::uint64_t unsent = 0;    ///< feedback and results that exceed a bound, or that Fast DDS does not take
  std::uint64_t unasked = 0;   ///< feedback and results when no goal was under way
  std::uint32_t waiting = 0;   ///< requests now for results that have not come yet
  std::uint32_t clients = 0;   ///< now
};

/// All counted since the task was configured.
struct ServerStatistics {
  std::uint64_t requests = 0;    ///< that were written to `request`
  std::uint64_t responses = 0;   ///< that were sent
  std::uint64_t refused = 0;     ///< requests when too many waited, or a connection of `request` had no room
  std::uint64_t corrupt = 0;     ///< requests that are no such messages
  std::uint64_t unsent = 0;      ///< responses that exceed a bound, or that Fast DDS does not take
  std::uint64_t unanswered = 0;  ///< requests to which no response came in time
  std::uint64_t unasked = 0;     ///< responses when no request was under way
  std::uint64_t early = 0;       ///< requests that came while the task did not run
  std::uint32_t waiting = 0;     ///< requests now, beside the one that is served
  std::uint32_t clients = 0;     ///< now
};

/// All counted since the task was started.
struct ExposureStatistics {
  std::uint64_t requests = 0;   ///< that were carried out, or refused with a reason
  std::uint64_t responses = 0;  ///< that were sent
  std::uint64_t dropped = 0;    ///< requests when too many waited, or that had waited too long
  std::uint64_t corrupt = 0;    ///< requests that are no such messages
  std::uint64_t unsent = 0;  ///< responses that a client did not get in time, or that Fast DDS does not take
  std::uint32_t nodes = 0;   ///< tasks that are nodes now
};

SEGUE_TYPE(PublisherStatistics, sent, refused, bytes, missed, matched, mismatched)
SEGUE_TYPE(SubscriptionStatistics, received, early, refused, lost, corrupt, foreign, bytes, missed, matched,
           mismatched)
SEGUE_TYPE(PublishedStatistics, port, topic, counts)
SEGUE_TYPE(SubscribedStatistics, port, topic, counts)
SEGUE_TYPE(NodeStatistics, publishes, subscribes)
SEGUE_TYPE(ServerStatistics, requests, responses, refused, corrupt, unsent, unanswered, unasked, early,
           waiting, clients)
SEGUE_TYPE(ActionServerStatistics, goals, rejected, feedback, refused, corrupt, unsent, unasked, waiting,
           clients)
SEGUE_TYPE(ExposureStatistics, requests, responses, dropped, corrupt, unsent, nodes)
SEGUE_TYPE(ActionStatistics, goals, feedback, corrupt, servers)

}  // namespace ros2
