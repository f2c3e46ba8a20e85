// SPDX-License-Identifier: Apache-2.0
#include "raw_dds.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

namespace bench {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// The payload is made elsewhere, as in ROS 2.
class PayloadType final : public dds::TopicDataType {
 public:
  PayloadType() {
    setName("bench_msgs::msg::dds_::Stamped_");
    m_typeSize = 512;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const Payload*>(data);
    if (payload->max_size < bytes.size()) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    const auto* begin = reinterpret_cast<const std::byte*>(payload->data);
    static_cast<Payload*>(data)->assign(begin, begin + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Payload*>(data)->size()); };
  }
  void* createData() override { return new Payload; }
  void deleteData(void* data) override { delete static_cast<Payload*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// A participant with the topic. By UDP on this computer, as Segue's.
struct RawTopic {
  explicit RawTopic(std::uint32_t domain) {
    dds::DomainParticipantQos quality;
    const std::string user_data = "enclave=/;";
    quality.user_data().setValue({user_data.begin(), user_data.end()});
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    constexpr std::uint32_t kSocketBytes = 4U << 20U;  // as Segue's, where the system allows it
    udp->sendBufferSize = udp->receiveBufferSize = kSocketBytes;
    udp->interfaceWhiteList = {"127.0.0.1"};
    quality.transport().use_builtin_transports = false;
    quality.transport().user_transports = {udp};
    participant = dds::DomainParticipantFactory::get_instance()->create_participant(domain, quality);
    if (participant == nullptr) std::abort();
    dds::TypeSupport(new PayloadType).register_type(participant);
    topic = participant->create_topic("rt/stamped", "bench_msgs::msg::dds_::Stamped_", dds::TopicQos());
  }
  ~RawTopic() {
    participant->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
  RawTopic(const RawTopic&) = delete;
  RawTopic& operator=(const RawTopic&) = delete;

  dds::DomainParticipant* participant = nullptr;
  dds::Topic* topic = nullptr;
};

/// ROS 2's default: reliable, volatile, the last ten.
template <class Qos>
Qos default_quality() {
  Qos quality;
  quality.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  quality.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  quality.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  quality.history().depth = 10;
  quality.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  quality.data_sharing().off();
  return quality;
}

}  // namespace

struct RawWriter::Parts {
  RawTopic topic;
  dds::DataWriter* writer = nullptr;
};

RawWriter::RawWriter(std::uint32_t domain) : parts_(new Parts{RawTopic(domain), nullptr}) {
  auto* publisher = parts_->topic.participant->create_publisher(dds::PublisherQos());
  auto quality = default_quality<dds::DataWriterQos>();
  quality.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  parts_->writer = publisher->create_datawriter(parts_->topic.topic, quality);
}

RawWriter::~RawWriter() = default;

std::size_t RawWriter::readers() const {
  dds::PublicationMatchedStatus status;
  parts_->writer->get_publication_matched_status(status);
  return static_cast<std::size_t>(status.current_count);
}

void RawWriter::write(Payload& message) {
  parts_->writer->write(&message);
}

struct RawReader::Parts final : dds::DataReaderListener {
  Parts(std::uint32_t domain, bool by_thread, std::function<void(const Payload&)> arrived_)
      : topic(domain), arrived(std::move(arrived_)) {
    if (by_thread) thread = std::thread([this] { wait(); });
    auto* subscriber = topic.participant->create_subscriber(dds::SubscriberQos());
    reader = subscriber->create_datareader(topic.topic, default_quality<dds::DataReaderQos>(), this);
  }
  ~Parts() override {
    reader->set_listener(nullptr);
    {
      const segue::Lock lock(mutex);
      ends = true;
    }
    changed.notify_all();
    if (thread.joinable()) thread.join();
  }

  void on_data_available(dds::DataReader* one) override {
    if (!thread.joinable()) return take(*one);
    {
      const segue::Lock lock(mutex);
      available = one;
    }
    changed.notify_all();
  }
  void take(dds::DataReader& one) {
    dds::SampleInfo info;
    while (one.take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) arrived(message);
    }
  }
  void wait() {
    segue::Lock lock(mutex);
    while (!ends) {
      if (auto* one = std::exchange(available, nullptr); one != nullptr) {
        lock.unlock();
        take(*one);
        lock.lock();
      } else {
        changed.wait(mutex);
      }
    }
  }

  RawTopic topic;
  const std::function<void(const Payload&)> arrived;
  dds::DataReader* reader = nullptr;
  Payload message;
  segue::Mutex mutex;
  segue::ConditionVariable changed;
  dds::DataReader* available SEGUE_GUARDED_BY(mutex) = nullptr;
  bool ends SEGUE_GUARDED_BY(mutex) = false;
  std::thread thread;
};

RawReader::RawReader(std::uint32_t domain, bool by_thread, std::function<void(const Payload&)> arrived)
    : parts_(std::make_unique<Parts>(domain, by_thread, std::move(arrived))) {}

RawReader::~RawReader() = default;

}  // namespace bench
