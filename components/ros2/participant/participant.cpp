// SPDX-License-Identifier: Apache-2.0
#include "participant.hpp"
#include "fast_quality.hpp"
#include "participant_quality.hpp"
#include "static_peers.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;
namespace rtps = eprosima::fastrtps::rtps;

constexpr std::uint32_t kLargestDomain = 232;  // the ports of larger ones do not exist
const TopicName kNodesTopic{"ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"};
/// Nodes on Cyclone DDS warn of endpoints that do not tell the hash of their type.
const std::string kNodesHash =
    "typehash=RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e;";
/// Between leaving and joining again. Readers of Fast DDS (2.9.1) that are at a message of the one that
/// leaves may count it for the next one, where this comes at once, and take what that one says for known.
constexpr std::chrono::milliseconds kAbsence{100};

/// Of what a participant says of itself.
const std::string kNotTaken = "what it says of itself is not taken: ";

/// The messages of Fast DDS go to the log of this process.
class LogLines final : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    const auto level = entry.kind == dds::Log::Error ? segue::LogLevel::Error : segue::LogLevel::Warning;
    segue::log(level, "ros2", entry.message);
  }
};

void take_log_lines() {
  [[maybe_unused]] static const bool taken = [] {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<LogLines>());
    return true;
  }();
}

/// When a participant of this process has left; the epoch: none has.
std::atomic<segue::TimePoint>& left_at() {
  static std::atomic<segue::TimePoint> time{segue::TimePoint()};
  return time;
}

std::string to_string(const Settings& settings) {
  std::string text = "domain " + std::to_string(settings.domain);
  if (settings.range == Range::Off) return text + ", without others";
  text += settings.range == Range::Localhost ? ", on this computer only" : ", on all networks";
  for (const std::string& peer : settings.static_peers)
    text += ", " + peer;
  return text;
}

template <class Locators>
std::vector<segue::ros2::UdpAddress> addresses_of(const Locators& locators) {
  std::vector<segue::ros2::UdpAddress> found;
  for (const rtps::Locator_t& locator : locators) {
    if (locator.kind != LOCATOR_KIND_UDPv4) continue;
    segue::ros2::UdpAddress address;
    std::copy_n(rtps::IPLocator::getIPv4(locator), address.host.size(), address.host.begin());
    address.port = rtps::IPLocator::getPhysicalPort(locator);
    found.push_back(address);
  }
  return found;
}

/// As Fast DDS prints it: "01.0f.3a..."
std::string name_of(const segue::ros2::Gid& participant) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string name;
  for (const std::uint8_t one : std::span(participant).first(rtps::GuidPrefix_t::size)) {
    if (!name.empty()) name += '.';
    name += kDigits[one / 16];
    name += kDigits[one % 16];
  }
  return name;
}

/// The nodes of other participants that wait to be read.
class EntitiesSink final : public MessageSink {
 public:
  bool take(std::span<const std::byte> bytes) noexcept override {
    try {
      entities = segue::ros2::decode_participant_entities(bytes);
    } catch (const std::bad_alloc&) {
      entities.reset();
    }
    return entities.has_value();
  }
  std::optional<segue::ros2::ParticipantEntities> entities;
};

}  // namespace

/// Reads which nodes other participants have.
class Participant::DiscoveryReader final : public dds::DataReaderListener {
 public:
  explicit DiscoveryReader(Participant& participant) : participant_(participant) {}
  void on_data_available(dds::DataReader* reader) override {
    EntitiesSink sink;
    dds::SampleInfo info;
    while (reader->take_next_sample(&sink, &info) == ReturnCode_t::RETCODE_OK) {
      take(sink, gid_of(info.sample_identity.writer_guid()));
      sink.entities.reset();
    }
    participant_.tell_watchers();
  }

 private:
  void take(const EntitiesSink& sink, const segue::ros2::Gid& sender) {
    if (!sink.entities) return;
    if (auto checked = check(*sink.entities, sender)) {
      participant_.graph_.set(*sink.entities);
    } else {
      participant_.refuse(sender, kNotTaken + checked.error().message);
    }
  }

  Participant& participant_;
};

segue::Result<std::shared_ptr<Participant>> Participant::join(const Settings& settings) {
  static segue::Mutex mutex;
  static std::weak_ptr<Participant> current;
  if (settings.domain > kLargestDomain) {
    return fail(ErrorCode::InvalidArgument, "domain " + std::to_string(settings.domain) +
                                                " does not exist; choose one of 0 to " +
                                                std::to_string(kLargestDomain));
  }
  const segue::Lock lock(mutex);
  if (auto joined = current.lock()) {
    if (joined->settings_ == settings) return joined;
    return fail(ErrorCode::InvalidState, "this process already takes part in ROS 2 with other settings (" +
                                             to_string(joined->settings_) + ") than this task's (" +
                                             to_string(settings) +
                                             "); give all tasks of a process that speak ROS 2 the same");
  }
  segue::RealClock::instance().sleep_until(left_at().load() + kAbsence);
  const std::shared_ptr<Participant> made(new Participant(settings));
  if (auto started = made->start(); !started) return started.error();
  current = made;
  return made;
}

Participant::Participant(const Settings& settings) : settings_(settings) {}

segue::Result<void> Participant::start() {
  take_log_lines();
  auto peers = addresses_of_peers(settings_.static_peers);
  if (!peers) return peers.error();
  auto* factory = dds::DomainParticipantFactory::get_instance();
  const auto listens = std::make_shared<std::atomic<bool>>(false);
  const TransportOptions options{[this](const segue::ros2::Acknowledgement& one) { acknowledged(one); },
                                 [this](const segue::ros2::Gid& sender, std::string_view why) {
                                   refuse(sender, "a part of a message is not taken: " + std::string(why));
                                 },
                                 settings_.range == Range::Localhost,
                                 *peers,
                                 settings_.range == Range::Off,
                                 listens,
                                 receiving_};
  participant_ = factory->create_participant(
      settings_.domain, participant_quality(settings_, *peers, options), this, dds::StatusMask::none());
  listens->store(true, std::memory_order_relaxed);
  if (participant_ == nullptr)
    return fail(ErrorCode::Unavailable, "Fast DDS cannot start (" + to_string(settings_) + ")");
  gid_ = gid_of(participant_->guid());
  publisher_ = participant_->create_publisher(dds::PublisherQos());
  subscriber_ = participant_->create_subscriber(dds::SubscriberQos());
  if (publisher_ == nullptr || subscriber_ == nullptr)
    return fail(ErrorCode::Unavailable, "Fast DDS cannot make a publisher and a subscriber");
  segue::ros2::Quality latched;
  latched.durability = segue::ros2::Durability::TransientLocal;
  latched.depth = 0;
  discovery_ = std::make_unique<DiscoveryReader>(*this);
  auto reader = make_reader(kNodesTopic, latched, kNodesHash, discovery_.get());
  if (!reader) return reader.error();
  nodes_reader_ = std::move(*reader);
  latched.depth = 1;
  auto writer = make_writer(kNodesTopic, latched, kNodesHash, nullptr);
  if (!writer) return writer.error();
  const segue::Lock lock(nodes_mutex_);
  own_.participant = gid_;
  follow_readers_of_nodes();
  nodes_writer_ = std::move(*writer);
  publish_nodes();
  return {};
}

Participant::~Participant() {
  if (participant_ == nullptr) return;
  nodes_reader_.reset();
  Owned<dds::DataWriter> nodes_writer;
  {
    const segue::Lock lock(nodes_mutex_);
    nodes_writer = std::move(nodes_writer_);
  }
  nodes_writer.reset();  // without the lock, which who receives may wait for
  {
    const segue::Lock receiving(*receiving_);
    participant_->set_listener(nullptr);
    participant_->delete_contained_entities();
  }
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  left_at().store(segue::monotonic_now());
}

bool Participant::sees_node(std::string_view name, std::uint64_t after) const {
  return graph_.has_node(name, gid_, after);
}

segue::Result<dds::Topic*> Participant::use(const TopicName& name) {
  UsedTopic& used = topics_[name.topic];
  if (used.topic != nullptr) {
    if (used.type != name.type) {
      return fail(ErrorCode::InvalidState, "a task of this process has topic " +
                                               segue::ros2::topic_of_dds_name(name.topic) + " with type " +
                                               segue::ros2::interface_of_dds_type(used.type));
    }
    ++used.uses;
    return used.topic;
  }
  dds::TypeSupport type = participant_->find_type(name.type);
  if (type.empty()) {
    type = dds::TypeSupport(new OpaqueType(name.type));
    type.register_type(participant_);
  }
  dds::Topic* made = participant_->create_topic(name.topic, name.type, dds::TopicQos());
  if (made == nullptr) {
    topics_.erase(name.topic);
    return fail(ErrorCode::Unavailable, "Fast DDS cannot make the topic " + quote(name.topic));
  }
  used = {name.type, made, 1};
  return made;
}

void Participant::leave(const std::string& topic) {
  const auto used = topics_.find(topic);
  if (used == topics_.end() || --used->second.uses > 0) return;
  participant_->delete_topic(used->second.topic);
  topics_.erase(used);
}

segue::Result<Participant::Owned<dds::DataWriter>> Participant::make_writer(
    const TopicName& name, const segue::ros2::Quality& quality, const std::string& user_data,
    dds::DataWriterListener* listener, Memory memory) {
  const segue::Lock lock(entities_mutex_);
  auto topic = use(name);
  if (!topic) return topic.error();
  dds::DataWriterQos wanted = writer_quality(quality, user_data);
  if (memory == Memory::AsNeeded) wanted.resource_limits().allocated_samples = 1;
  auto* made = publisher_->create_datawriter(*topic, wanted, listener);
  if (made != nullptr) {
    return Owned<dds::DataWriter>(made, [this, topic = name.topic](dds::DataWriter* writer) {
      const segue::Lock deleting(entities_mutex_);
      const segue::Lock receiving(*receiving_);
      // Its samples first: Fast DDS 2.9 releases those that are left without a lock, while its timer may be
      // looking at them, which then goes on for ever (StatefulWriter::add_gaps_for_holes_in_history_).
      std::size_t removed = 0;
      writer->clear_history(&removed);
      publisher_->delete_datawriter(writer);
      leave(topic);
    });
  }
  leave(name.topic);
  return fail(ErrorCode::Unavailable, "Fast DDS cannot make a publisher of " +
                                          segue::ros2::topic_of_dds_name(name.topic) +
                                          " with these qualities");
}

segue::Result<Participant::Owned<dds::DataReader>> Participant::make_reader(
    const TopicName& name, const segue::ros2::Quality& quality, const std::string& user_data,
    dds::DataReaderListener* listener, Memory memory) {
  const segue::Lock lock(entities_mutex_);
  auto topic = use(name);
  if (!topic) return topic.error();
  dds::DataReaderQos wanted = reader_quality(quality, user_data);
  if (memory == Memory::AsNeeded) wanted.resource_limits().allocated_samples = 1;
  auto* made = subscriber_->create_datareader(*topic, wanted, listener);
  if (made != nullptr) {
    return Owned<dds::DataReader>(made, [this, topic = name.topic](dds::DataReader* reader) {
      const segue::Lock deleting(entities_mutex_);
      const segue::Lock receiving(*receiving_);
      subscriber_->delete_datareader(reader);
      leave(topic);
    });
  }
  leave(name.topic);
  return fail(ErrorCode::Unavailable, "Fast DDS cannot make a subscription to " +
                                          segue::ros2::topic_of_dds_name(name.topic) +
                                          " with these qualities");
}

void Participant::announce(const segue::ros2::NodeEntities& node) {
  const segue::Lock lock(nodes_mutex_);
  std::erase_if(own_.nodes, [&](const auto& other) { return full_name(other) == full_name(node); });
  own_.nodes.push_back(node);
  publish_nodes();
}

void Participant::withdraw(const segue::ros2::NodeEntities& node) {
  const segue::Lock lock(nodes_mutex_);
  std::erase_if(own_.nodes, [&](const auto& other) { return full_name(other) == full_name(node); });
  publish_nodes();
}

void Participant::publish_nodes() {
  const auto bytes = segue::ros2::encode(own_);
  BytesSource message(bytes);
  nodes_writer_->write(static_cast<MessageSource*>(&message));
}

void Participant::found_reader_of_nodes(const segue::ros2::Gid& reader, bool before_iron) {
  const segue::Lock lock(nodes_mutex_);
  if (before_iron) {
    readers_before_iron_.insert(reader);
  } else {
    readers_before_iron_.erase(reader);
  }
  follow_readers_of_nodes();
}

void Participant::lost_reader_of_nodes(const segue::ros2::Gid& reader) {
  const segue::Lock lock(nodes_mutex_);
  if (readers_before_iron_.erase(reader) > 0) follow_readers_of_nodes();
}

/// Those from Iron on read a message of before as one without nodes. Those of before take gigabytes for one
/// from Iron on (seen with Humble), so they never get any: before Fast DDS matches such a reader, the latched
/// message is replaced.
void Participant::follow_readers_of_nodes() {
  const bool before_iron = !readers_before_iron_.empty();
  if (std::exchange(own_.before_iron, before_iron) != before_iron && nodes_writer_ != nullptr)
    publish_nodes();
}

void Participant::watch(const void* owner, std::function<void()> changed) {
  const segue::Lock lock(watchers_mutex_);
  watchers_[owner] = std::move(changed);
}

void Participant::stop_watching(const void* owner) {
  const segue::Lock lock(watchers_mutex_);
  watchers_.erase(owner);
}

void Participant::tell_watchers() {
  const segue::Lock lock(watchers_mutex_);
  for (const auto& [owner, changed] : watchers_)
    changed();
}

void Participant::on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) {
  const segue::ros2::Gid gid = gid_of(info.info.m_guid);
  if (info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
      info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT) {
    graph_.remove_participant(gid);
    return tell_watchers();
  }
  const auto& data = info.info.m_userData.data_vec();
  if (std::string_view(reinterpret_cast<const char*>(data.data()), data.size()).starts_with("enclave="))
    graph_.add_participant(gid, addresses_of(info.info.metatraffic_locators.unicast));
  tell_watchers();
}

void Participant::set(segue::ros2::Endpoint endpoint) {
  if (auto checked = check(endpoint)) {
    graph_.set(std::move(endpoint));
  } else {
    refuse(endpoint.gid, kNotTaken + checked.error().message);
  }
}

void Participant::refuse(const segue::ros2::Gid& sender, const std::string& why) {
  constexpr std::size_t kMostLogged = 100;
  segue::ros2::Gid participant{};
  std::copy_n(sender.begin(), rtps::GuidPrefix_t::size, participant.begin());
  const segue::Lock lock(refused_mutex_);
  if (refused_.size() >= kMostLogged || !refused_.insert(participant).second) return;
  segue::log(segue::LogLevel::Warning, "ros2",
             "participant " + name_of(participant) + ": " + why +
                 (refused_.size() == kMostLogged ? "; others will not be logged" : ""));
}

void Participant::on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) {
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    graph_.remove(gid_of(info.info.guid()));
  } else {
    const std::string told = user_data_of(info.info.m_qos);
    set({gid_of(info.info.guid()), true, info.info.topicName().to_string(), info.info.typeName().to_string(),
         segue::ros2::type_hash_in(told), quality_of(info.info.m_qos), segue::ros2::service_hash_in(told)});
  }
  tell_watchers();
}

segue::Result<Participant::Owned<dds::DataWriter>> Participant::make_acknowledged_writer(
    const TopicName& name, const segue::ros2::Quality& quality, const std::string& user_data,
    dds::DataWriterListener* listener) {
  {
    const segue::Lock lock(acknowledged_mutex_);
    ++being_made_;
  }
  auto writer = make_writer(name, quality, user_data, listener, Memory::AsNeeded);
  const segue::Lock lock(acknowledged_mutex_);
  --being_made_;
  if (writer) {
    const segue::ros2::Gid gid = gid_of((*writer)->guid());
    awaited_.insert(gid);
    std::ranges::copy_if(early_, std::inserter(acknowledged_, acknowledged_.end()),
                         [&](const segue::ros2::Acknowledgement& one) { return one.writer == gid; });
  }
  if (being_made_ == 0) early_.clear();
  return writer;
}

void Participant::forget_acknowledgements(const segue::ros2::Gid& writer) {
  const segue::Lock lock(acknowledged_mutex_);
  awaited_.erase(writer);
  std::erase_if(acknowledged_, [&](const segue::ros2::Acknowledgement& one) { return one.writer == writer; });
}

void Participant::forget_reader(const segue::ros2::Gid& reader) {
  const segue::Lock lock(acknowledged_mutex_);
  std::erase_if(acknowledged_, [&](const segue::ros2::Acknowledgement& one) { return one.reader == reader; });
}

bool Participant::has_acknowledged(const segue::ros2::Gid& reader, const segue::ros2::Gid& writer) const {
  const segue::Lock lock(acknowledged_mutex_);
  return acknowledged_.contains({reader, writer});
}

void Participant::acknowledged(const segue::ros2::Acknowledgement& one) {
  {
    const segue::Lock lock(acknowledged_mutex_);
    if (being_made_ > 0 && !awaited_.contains(one.writer)) early_.insert(one);
    if (!awaited_.contains(one.writer) || !acknowledged_.insert(one).second) return;
  }
  tell_watchers();
}

void Participant::on_subscriber_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) {
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    graph_.remove(gid_of(info.info.guid()));
    forget_reader(gid_of(info.info.guid()));
    lost_reader_of_nodes(gid_of(info.info.guid()));
  } else {
    const std::string told = user_data_of(info.info.m_qos);
    if (info.info.topicName() == kNodesTopic.topic)
      found_reader_of_nodes(gid_of(info.info.guid()), segue::ros2::type_hash_in(told).empty());
    set({gid_of(info.info.guid()), false, info.info.topicName().to_string(), info.info.typeName().to_string(),
         segue::ros2::type_hash_in(told), quality_of(info.info.m_qos), segue::ros2::service_hash_in(told)});
  }
  tell_watchers();
}

segue::ros2::Gid gid_of(const rtps::GUID_t& guid) {
  segue::ros2::Gid gid{};
  auto* after = std::copy_n(std::begin(guid.guidPrefix.value), rtps::GuidPrefix_t::size, gid.begin());
  std::copy_n(std::begin(guid.entityId.value), rtps::EntityId_t::size, after);
  return gid;
}

}  // namespace ros2
