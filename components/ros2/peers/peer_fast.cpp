// SPDX-License-Identifier: Apache-2.0
#include "peer.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/ros2/dds_names.hpp>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>

namespace ros2::testing {
namespace {

namespace edds = eprosima::fastdds::dds;
namespace ertps = eprosima::fastrtps::rtps;
using segue::ros2::Gid;
using segue::ros2::ParticipantEntities;
using segue::ros2::Quality;

/// As the type support of rmw_fastrtps with dynamic types: the payload is made elsewhere.
class BytesType final : public edds::TopicDataType {
 public:
  explicit BytesType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1024;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, ertps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const Bytes*>(data);
    if (payload->max_size < bytes.size()) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(ertps::SerializedPayload_t* payload, void* data) override {
    const auto* begin = reinterpret_cast<const std::byte*>(payload->data);
    static_cast<Bytes*>(data)->assign(begin, begin + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, ertps::InstanceHandle_t*, bool) override { return false; }
};

template <class Qos>
Qos quality_of(const Quality& quality, const std::string& user_data) {
  Qos made;
  made.reliability().kind = quality.reliability == segue::ros2::Reliability::Reliable
                                ? edds::RELIABLE_RELIABILITY_QOS
                                : edds::BEST_EFFORT_RELIABILITY_QOS;
  made.durability().kind = quality.durability == segue::ros2::Durability::TransientLocal
                               ? edds::TRANSIENT_LOCAL_DURABILITY_QOS
                               : edds::VOLATILE_DURABILITY_QOS;
  made.history().kind = quality.depth == 0 ? edds::KEEP_ALL_HISTORY_QOS : edds::KEEP_LAST_HISTORY_QOS;
  made.history().depth = static_cast<std::int32_t>(std::max(quality.depth, 1U));
  if (quality.deadline.count() > 0)
    made.deadline().period = {0, static_cast<std::uint32_t>(quality.deadline.count())};
  if (quality.liveliness == segue::ros2::Liveliness::ManualByTopic)
    made.liveliness().kind = edds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
  if (quality.lease.count() > 0) {
    made.liveliness().lease_duration = {0, static_cast<std::uint32_t>(quality.lease.count())};
    made.liveliness().announcement_period = {0, static_cast<std::uint32_t>(quality.lease.count() / 2)};
  }
  made.endpoint().history_memory_policy = ertps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  made.data_sharing().off();
  made.user_data().setValue({user_data.begin(), user_data.end()});
  return made;
}

Gid gid_of(const ertps::GUID_t& guid) {
  Gid gid{};
  std::memcpy(gid.data(), guid.guidPrefix.value, ertps::GuidPrefix_t::size);
  std::memcpy(gid.data() + ertps::GuidPrefix_t::size, guid.entityId.value, ertps::EntityId_t::size);
  return gid;
}

/// The user data of publishers by topic.
class Discovery final : public edds::DomainParticipantListener {
 public:
  void on_publisher_discovery(edds::DomainParticipant*, ertps::WriterDiscoveryInfo&& info) override {
    const segue::Lock lock(mutex_);
    const auto& data = info.info.m_qos.m_userData.data_vec();
    user_data_[info.info.topicName().to_string()] = std::string(data.begin(), data.end());
  }
  std::string user_data(const std::string& topic) {
    const segue::Lock lock(mutex_);
    return user_data_[topic];
  }

 private:
  segue::Mutex mutex_;
  std::map<std::string, std::string> user_data_ SEGUE_GUARDED_BY(mutex_);
};

/// The number of a participant in this process, from which its ports follow: the smallest that is free. (Fast
/// DDS would count on, until the ports are those of the next domain.)
class PeerNumber {
 public:
  PeerNumber() {
    const segue::Lock lock(mutex());
    while (!used().insert(value_).second)
      ++value_;
  }
  ~PeerNumber() {
    const segue::Lock lock(mutex());
    used().erase(value_);
  }
  PeerNumber(const PeerNumber&) = delete;
  PeerNumber& operator=(const PeerNumber&) = delete;
  [[nodiscard]] std::int32_t value() const { return value_; }

 private:
  static segue::Mutex& mutex() {
    static segue::Mutex one;
    return one;
  }
  static std::set<std::int32_t>& used() {
    static std::set<std::int32_t> numbers;
    return numbers;
  }
  std::int32_t value_ = 10;  // beside that of the participant that is tested
};

/// The readers of clients that get responses.
class Clients final : public edds::DataWriterListener {
 public:
  void on_publication_matched(edds::DataWriter*, const edds::PublicationMatchedStatus& status) override {
    const ertps::GUID_t reader = ertps::iHandle2GUID(status.last_subscription_handle);
    const segue::Lock lock(mutex_);
    if (status.current_count_change > 0) {
      readers_.insert(reader);
    } else {
      readers_.erase(reader);
    }
    changed_.notify_all();
  }
  /// As rmw_fastrtps does, which waits for less time than a loaded machine needs.
  void wait_for(const ertps::GUID_t& reader) {
    segue::Lock lock(mutex_);
    changed_.wait_until(mutex_, std::chrono::steady_clock::now() + std::chrono::seconds(5),
                        [&]() SEGUE_REQUIRES(mutex_) { return readers_.contains(reader); });
  }

 private:
  segue::Mutex mutex_;
  segue::ConditionVariable changed_;
  std::set<ertps::GUID_t> readers_ SEGUE_GUARDED_BY(mutex_);
};

/// A participant with what all its peers share.
struct FastParticipant {
  explicit FastParticipant(std::uint32_t domain) {
    // Both ends are in one process: what goes between them shall go as between two.
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
    edds::DomainParticipantQos quality;
    const std::string user_data = "enclave=/;";
    quality.user_data().setValue({user_data.begin(), user_data.end()});
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    quality.transport().use_builtin_transports = false;
    quality.wire_protocol().participant_id = number.value();
    quality.wire_protocol().prefix = identifier();
    quality.transport().user_transports = {udp};
    participant = edds::DomainParticipantFactory::get_instance()->create_participant(
        domain, quality, &discovery, edds::StatusMask::none());
    if (participant == nullptr) std::abort();
    publisher = participant->create_publisher(edds::PublisherQos());
    subscriber = participant->create_subscriber(edds::SubscriberQos());
  }
  ~FastParticipant() {
    participant->set_listener(nullptr);
    participant->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
  /// That nobody had before, as those of other processes, of which the number is a part otherwise.
  static ertps::GuidPrefix_t identifier() {
    ertps::GuidPrefix_t prefix;
    std::random_device random;
    for (auto& one : prefix.value)
      one = static_cast<ertps::octet>(random());
    prefix.value[0] = ertps::c_VendorId_eProsima[0];
    prefix.value[1] = ertps::c_VendorId_eProsima[1];
    return prefix;
  }
  FastParticipant(const FastParticipant&) = delete;
  FastParticipant& operator=(const FastParticipant&) = delete;

  const PeerNumber number;
  bool outlives_peers = false;
  Discovery discovery;
  Clients clients;  ///< of all its services
  edds::DomainParticipant* participant = nullptr;
  edds::Publisher* publisher = nullptr;
  edds::Subscriber* subscriber = nullptr;
  edds::DataWriter* entities_out = nullptr;
  std::map<const Peer*, segue::ros2::NodeEntities> nodes;  ///< as each has announced
};

/// Peers with one name are one node.
void add(const segue::ros2::NodeEntities& part, std::vector<segue::ros2::NodeEntities>& nodes) {
  auto node = std::ranges::find(nodes, part.name, &segue::ros2::NodeEntities::name);
  if (node == nodes.end()) node = nodes.insert(nodes.end(), {part.name_space, part.name});
  node->publishers.insert(node->publishers.end(), part.publishers.begin(), part.publishers.end());
  node->subscriptions.insert(node->subscriptions.end(), part.subscriptions.begin(), part.subscriptions.end());
}

class FastPeer final : public Peer {
 public:
  explicit FastPeer(std::shared_ptr<FastParticipant> participant, bool before_iron = false)
      : Peer(before_iron),
        shared_(std::move(participant)),
        participant_(shared_->participant),
        publisher_(shared_->publisher),
        subscriber_(shared_->subscriber) {
    Quality latched;
    latched.durability = segue::ros2::Durability::TransientLocal;
    latched.depth = 1;
    auto* nodes = topic("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
    if (shared_->entities_out == nullptr)
      shared_->entities_out = publisher_->create_datawriter(
          nodes, quality_of<edds::DataWriterQos>(latched, hash_data(entities_hash())));
    latched.depth = 0;
    entities_in_ = subscriber_->create_datareader(
        nodes, quality_of<edds::DataReaderQos>(latched, hash_data(entities_hash())));
  }
  /// Where the participant goes on, its endpoints leave; else they leave with it.
  ~FastPeer() override {
    if (!shared_->outlives_peers) return;
    stop_serving();
    for (edds::DataWriter* writer : {out_, asks_})
      if (writer != nullptr) publisher_->delete_datawriter(writer);
    for (edds::DataReader* reader : {in_, answers_, entities_in_})
      if (reader != nullptr) subscriber_->delete_datareader(reader);
    if (shared_->nodes.erase(this) > 0) say_nodes();
  }

  void advertise(const TopicOf& wanted) override {
    if (out_ != nullptr) publisher_->delete_datawriter(out_);
    out_ = publisher_->create_datawriter(
        topic_of(wanted), quality_of<edds::DataWriterQos>(wanted.quality, hash_data(wanted.hash)));
  }
  void subscribe(const TopicOf& wanted) override {
    if (in_ != nullptr) subscriber_->delete_datareader(in_);
    in_ = subscriber_->create_datareader(
        topic_of(wanted), quality_of<edds::DataReaderQos>(wanted.quality, hash_data(wanted.hash)));
    subscribed_ = segue::ros2::dds_topic_name(wanted.topic).value();
  }
  void announce(const std::string& node) override {
    segue::ros2::NodeEntities entities{"/", node, {}, {}};
    if (in_ != nullptr) entities.subscriptions.push_back(gid_of(in_->guid()));
    if (out_ != nullptr) entities.publishers.push_back(gid_of(out_->guid()));
    if (requests_ != nullptr) entities.subscriptions.push_back(gid_of(requests_->guid()));
    if (responses_ != nullptr) entities.publishers.push_back(gid_of(responses_->guid()));
    shared_->nodes[this] = entities;
    say_nodes();
  }
  void say(const Bytes& entities) final {
    Bytes bytes = entities;
    shared_->entities_out->write(&bytes);
  }
  void advertise_more(const TopicOf& wanted, std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) {
      publisher_->create_datawriter(topic_of(wanted),
                                    quality_of<edds::DataWriterQos>(wanted.quality, hash_data(wanted.hash)));
    }
  }
  void publish(const Bytes& message) override {
    Bytes bytes = message;
    if (!out_->write(&bytes)) std::fprintf(stderr, "the peer cannot write\n");
  }
  std::vector<Bytes> take() override { return take(in_); }
  void serve(const std::string& service, const std::string& interface, const ServiceHashes& hashes) override {
    stop_serving();
    requests_ = subscriber_->create_datareader(
        topic(segue::ros2::dds_request_name(service).value(),
              segue::ros2::dds_type_name(interface + "_Request")),
        quality_of<edds::DataReaderQos>({}, hash_data(hashes.request, hashes.whole)));
    responses_ = publisher_->create_datawriter(
        topic(segue::ros2::dds_response_name(service).value(),
              segue::ros2::dds_type_name(interface + "_Response")),
        quality_of<edds::DataWriterQos>({}, hash_data(hashes.response, hashes.whole)), &shared_->clients);
  }
  void stop_serving() override {
    if (requests_ != nullptr) subscriber_->delete_datareader(requests_);
    if (responses_ != nullptr) publisher_->delete_datawriter(responses_);
    requests_ = nullptr;
    responses_ = nullptr;
  }
  /// Beside the message stands the reader of the client, and the number of the request in its writer.
  std::vector<Request> requests() override {
    std::vector<Request> all;
    Bytes message;
    edds::SampleInfo info;
    while (requests_->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      all.push_back({message, gid_of(info.related_sample_identity.writer_guid()),
                     static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long())});
    }
    return all;
  }
  void respond(const Request& request, const Bytes& response) override {
    ertps::GUID_t client;
    std::memcpy(client.guidPrefix.value, request.client.data(), ertps::GuidPrefix_t::size);
    std::memcpy(client.entityId.value, request.client.data() + ertps::GuidPrefix_t::size,
                ertps::EntityId_t::size);
    shared_->clients.wait_for(client);
    ertps::SampleIdentity identity;
    identity.writer_guid(client);
    identity.sequence_number(ertps::SequenceNumber_t(static_cast<std::uint64_t>(request.number)));
    ertps::WriteParams parameters;
    parameters.related_sample_identity(identity);
    Bytes bytes = response;
    if (!responses_->write(&bytes, parameters)) std::fprintf(stderr, "the peer cannot respond\n");
  }
  void use(const std::string& service, const std::string& interface) override {
    if (asks_ != nullptr) publisher_->delete_datawriter(asks_);
    if (answers_ != nullptr) subscriber_->delete_datareader(answers_);
    answers_ = subscriber_->create_datareader(topic(segue::ros2::dds_response_name(service).value(),
                                                    segue::ros2::dds_type_name(interface + "_Response")),
                                              quality_of<edds::DataReaderQos>({}, ""));
    asks_ = publisher_->create_datawriter(topic(segue::ros2::dds_request_name(service).value(),
                                                segue::ros2::dds_type_name(interface + "_Request")),
                                          quality_of<edds::DataWriterQos>({}, ""));
  }
  std::uint32_t servers() override {
    edds::SubscriptionMatchedStatus status;
    answers_->get_subscription_matched_status(status);
    return std::min(matched(*asks_), static_cast<std::uint32_t>(status.current_count));
  }
  /// Beside the message stands the reader of the responses.
  std::int64_t ask(const Bytes& request) override {
    ertps::SampleIdentity identity;
    identity.writer_guid(answers_->guid());
    ertps::WriteParams parameters;
    parameters.related_sample_identity(identity);
    Bytes bytes = request;
    if (!asks_->write(&bytes, parameters)) std::fprintf(stderr, "the peer cannot ask\n");
    return static_cast<std::int64_t>(parameters.sample_identity().sequence_number().to64long());
  }
  std::vector<Response> responses() override {
    std::vector<Response> all;
    Bytes message;
    edds::SampleInfo info;
    while (answers_->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      const auto& request = info.related_sample_identity;
      if (info.valid_data && request.writer_guid() == answers_->guid())
        all.push_back({static_cast<std::int64_t>(request.sequence_number().to64long()), message});
    }
    return all;
  }
  std::uint32_t subscriptions() override { return matched(*out_); }
  std::uint32_t clients() override { return matched(*responses_); }
  std::uint32_t publishers() override {
    edds::SubscriptionMatchedStatus status;
    in_->get_subscription_matched_status(status);
    return static_cast<std::uint32_t>(status.current_count);
  }
  std::string user_data_of_publisher() override { return shared_->discovery.user_data(subscribed_); }

 private:
  [[nodiscard]] Gid own_gid() const override { return gid_of(participant_->guid()); }
  std::vector<Bytes> take_entities() override { return take(entities_in_); }
  void say_nodes() {
    ParticipantEntities all{own_gid(), {}, is_before_iron()};
    for (const auto& [peer, part] : shared_->nodes)
      add(part, all.nodes);
    say(segue::ros2::encode(all));
  }
  static std::uint32_t matched(const edds::DataWriter& writer) {
    edds::PublicationMatchedStatus status;
    writer.get_publication_matched_status(status);
    return static_cast<std::uint32_t>(status.current_count);
  }
  edds::Topic* topic(const std::string& name, const std::string& type) {
    edds::Topic*& made = topics_[name];
    if (made == nullptr) made = static_cast<edds::Topic*>(participant_->lookup_topicdescription(name));
    if (made != nullptr) return made;
    edds::TypeSupport(new BytesType(type)).register_type(participant_);
    return made = participant_->create_topic(name, type, edds::TopicQos());
  }
  edds::Topic* topic_of(const TopicOf& wanted) {
    return topic(segue::ros2::dds_topic_name(wanted.topic).value(),
                 segue::ros2::dds_type_name(wanted.interface));
  }
  static std::vector<Bytes> take(edds::DataReader* reader) {
    std::vector<Bytes> all;
    Bytes message;
    edds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) all.push_back(message);
    }
    return all;
  }

  const std::shared_ptr<FastParticipant> shared_;
  edds::DomainParticipant* const participant_;
  edds::Publisher* const publisher_;
  edds::Subscriber* const subscriber_;
  edds::DataReader* entities_in_ = nullptr;
  edds::DataWriter* out_ = nullptr;
  edds::DataReader* in_ = nullptr;
  edds::DataReader* requests_ = nullptr;
  edds::DataWriter* responses_ = nullptr;
  edds::DataWriter* asks_ = nullptr;
  edds::DataReader* answers_ = nullptr;
  std::string subscribed_;
  std::map<std::string, edds::Topic*> topics_;
};

}  // namespace

std::unique_ptr<Peer> make_fast_peer(std::uint32_t domain) {
  return std::make_unique<FastPeer>(std::make_shared<FastParticipant>(domain));
}

std::unique_ptr<Peer> make_fast_peer_before_iron(std::uint32_t domain) {
  return std::make_unique<FastPeer>(std::make_shared<FastParticipant>(domain), true);
}

std::function<std::unique_ptr<Peer>()> fast_peers_of_one_node(std::uint32_t domain) {
  return [participant = std::make_shared<FastParticipant>(domain)] {
    return std::make_unique<FastPeer>(participant);
  };
}

std::function<std::unique_ptr<Peer>()> fast_peers_of_one_process(std::uint32_t domain) {
  auto participant = std::make_shared<FastParticipant>(domain);
  participant->outlives_peers = true;
  return [participant = std::move(participant)] { return std::make_unique<FastPeer>(participant); };
}

}  // namespace ros2::testing
