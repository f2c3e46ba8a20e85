// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "opaque_type.hpp"
#include "watched_transport.hpp"

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/ros2/node_graph.hpp>
#include <segue/ros2/participant_entities.hpp>
#include <segue/ros2/quality.hpp>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace ros2 {

namespace dds = eprosima::fastdds::dds;

/// On which computers others are looked for, without being named.
enum class Range {
  Subnet,
  Localhost,  ///< only on this one
  Off         ///< on none: this process is alone
};

/// Where ROS 2 is looked for.
struct Settings {
  std::uint32_t domain = 0;  ///< 0 to 232
  Range range = Range::Subnet;
  /// Computers that are asked in any range but Off, by names or IPv4 addresses.
  std::vector<std::string> static_peers{};
  friend bool operator==(const Settings&, const Settings&) = default;
};

/// A topic with its type, by their names on DDS.
struct TopicName {
  std::string topic;
  std::string type;
};

/// This process as a participant of ROS 2: its endpoints, its nodes, and what it sees of others. Any thread.
class Participant final : private dds::DomainParticipantListener,
                          public std::enable_shared_from_this<Participant> {
 public:
  /// The participant of this process, made where there is none yet; it leaves when the last one lets go of
  /// it. InvalidArgument: there is no such domain; InvalidState: this process takes part with other settings;
  /// Unavailable: Fast DDS cannot start.
  static segue::Result<std::shared_ptr<Participant>> join(const Settings& settings);
  ~Participant() override;
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// An endpoint on DDS, which leaves when it is let go of. Its listener is told until then, in threads of
  /// Fast DDS.
  template <class Entity>
  using Owned = std::unique_ptr<Entity, std::function<void(Entity*)>>;
  /// When the memory for samples is allocated: before the first one, or with each for which there is none,
  /// which costs a third of the memory where hardly anything is sent.
  enum class Memory : std::uint8_t { Ahead, AsNeeded };
  segue::Result<Owned<dds::DataWriter>> make_writer(const TopicName& name,
                                                    const segue::ros2::Quality& quality,
                                                    const std::string& user_data,
                                                    dds::DataWriterListener* listener,
                                                    Memory memory = Memory::Ahead);
  segue::Result<Owned<dds::DataReader>> make_reader(const TopicName& name,
                                                    const segue::ros2::Quality& quality,
                                                    const std::string& user_data,
                                                    dds::DataReaderListener* listener,
                                                    Memory memory = Memory::Ahead);

  /// Tells others of a node of this process, in place of what they were told of it.
  void announce(const segue::ros2::NodeEntities& node);
  void withdraw(const segue::ros2::NodeEntities& node);

  /// make_writer() with memory as needed, where it is known which readers of others have matched the writer,
  /// until that is forgotten; watchers are told of changes. (That this participant has matched a reader does
  /// not mean the reverse, and until then the reader gets nothing. A reader says it once.)
  segue::Result<Owned<dds::DataWriter>> make_acknowledged_writer(const TopicName& name,
                                                                 const segue::ros2::Quality& quality,
                                                                 const std::string& user_data,
                                                                 dds::DataWriterListener* listener);
  void forget_acknowledgements(const segue::ros2::Gid& writer);
  [[nodiscard]] bool has_acknowledged(const segue::ros2::Gid& reader, const segue::ros2::Gid& writer) const;

  [[nodiscard]] const Settings& settings() const { return settings_; }
  [[nodiscard]] segue::ros2::Gid gid() const { return gid_; }
  [[nodiscard]] const segue::ros2::NodeGraph& graph() const { return graph_; }
  /// Whether a participant of another process has that node ("/talker"); of those that have been found after
  /// so many others (NodeGraph::seen_so_far()).
  [[nodiscard]] bool sees_node(std::string_view name, std::uint64_t after = 0) const;
  /// `changed` is called in a thread of Fast DDS, after the graph has changed, until `owner` is told to stop.
  void watch(const void* owner, std::function<void()> changed);
  /// No call is made any more once it returns; not to be called by `changed`.
  void stop_watching(const void* owner);

 private:
  struct UsedTopic {
    std::string type;
    dds::Topic* topic = nullptr;
    std::size_t uses = 0;
  };
  class DiscoveryReader;

  explicit Participant(const Settings& settings);
  segue::Result<void> start();
  segue::Result<dds::Topic*> use(const TopicName& name) SEGUE_REQUIRES(entities_mutex_);
  void leave(const std::string& topic) SEGUE_REQUIRES(entities_mutex_);
  void publish_nodes() SEGUE_REQUIRES(nodes_mutex_);
  /// The reader gets nothing before this returns.
  void found_reader_of_nodes(const segue::ros2::Gid& reader, bool before_iron);
  void lost_reader_of_nodes(const segue::ros2::Gid& reader);
  void follow_readers_of_nodes() SEGUE_REQUIRES(nodes_mutex_);
  void set(segue::ros2::Endpoint endpoint);
  /// Logs that something is not taken, and why, once for each participant, and only so often for all of them.
  void refuse(const segue::ros2::Gid& sender, const std::string& why);
  void tell_watchers();
  void acknowledged(const segue::ros2::Acknowledgement& one);
  void forget_reader(const segue::ros2::Gid& reader);

  void on_participant_discovery(dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(dds::DomainParticipant* participant,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;

  const Settings settings_;
  segue::ros2::NodeGraph graph_;
  segue::Mutex refused_mutex_;
  std::set<segue::ros2::Gid> refused_
      SEGUE_GUARDED_BY(refused_mutex_);  ///< participants, as far as they were logged
  segue::Mutex watchers_mutex_;
  std::map<const void*, std::function<void()>> watchers_ SEGUE_GUARDED_BY(watchers_mutex_);
  mutable segue::Mutex acknowledged_mutex_;
  std::set<segue::ros2::Gid> awaited_ SEGUE_GUARDED_BY(acknowledged_mutex_);
  std::size_t being_made_ SEGUE_GUARDED_BY(acknowledged_mutex_) =
      0;  ///< writers, whose identifiers are not known yet
  std::set<segue::ros2::Acknowledgement> early_ SEGUE_GUARDED_BY(acknowledged_mutex_);  ///< of them perhaps
  std::set<segue::ros2::Acknowledgement> acknowledged_ SEGUE_GUARDED_BY(acknowledged_mutex_);
  /// One thread at a time makes or deletes entities: Fast DDS 2.9 has four places for endpoints that are
  /// being made or found, and where five threads need one, each may wait for another. No callback takes it.
  segue::Mutex entities_mutex_;
  /// Nothing is received while an endpoint is deleted (TransportOptions::receiving).
  const std::shared_ptr<segue::Mutex> receiving_ = std::make_shared<segue::Mutex>();
  std::map<std::string, UsedTopic> topics_ SEGUE_GUARDED_BY(entities_mutex_);
  dds::DomainParticipant* participant_ = nullptr;
  segue::ros2::Gid gid_{};
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::unique_ptr<DiscoveryReader> discovery_;
  Owned<dds::DataReader> nodes_reader_;
  segue::Mutex nodes_mutex_;
  Owned<dds::DataWriter> nodes_writer_ SEGUE_GUARDED_BY(nodes_mutex_);
  segue::ros2::ParticipantEntities own_ SEGUE_GUARDED_BY(nodes_mutex_);
  std::set<segue::ros2::Gid> readers_before_iron_ SEGUE_GUARDED_BY(nodes_mutex_);
};

/// The identifier of an endpoint, as ROS 2 tells it.
segue::ros2::Gid gid_of(const eprosima::fastrtps::rtps::GUID_t& guid);

}  // namespace ros2
