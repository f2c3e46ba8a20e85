// SPDX-License-Identifier: Apache-2.0
#include "peer.hpp"

#include "../../gateway/message.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/dds_names.hpp>

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <utility>

namespace ros2::testing {
namespace {

using segue::ros2::Gid;
using segue::ros2::ParticipantEntities;
using segue::ros2::Quality;

constexpr const char* kEntitiesType = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";
constexpr const char* kConfiguration =
    "<CycloneDDS><Domain Id='any'><General><AllowMulticast>true</AllowMulticast><Interfaces>"
    "<NetworkInterface name='lo' multicast='true'/></Interfaces></General></Domain></CycloneDDS>";

/// The domain of this process, which its participants share.
void open_domain(std::uint32_t domain) {
  static segue::Mutex mutex;
  static std::map<std::uint32_t, dds_entity_t> open;
  const segue::Lock lock(mutex);
  if (!open.contains(domain)) open[domain] = ::dds_create_domain(domain, kConfiguration);
}

void set_duration(dds_qos_t* made, std::chrono::nanoseconds duration,
                  void (*set)(dds_qos_t*, dds_duration_t)) {
  if (duration.count() > 0) set(made, duration.count());
}

dds_qos_t* quality_of(const Quality& quality, const std::string& user_data) {
  dds_qos_t* made = ::dds_create_qos();
  ::dds_qset_reliability(made,
                         quality.reliability == segue::ros2::Reliability::Reliable
                             ? DDS_RELIABILITY_RELIABLE
                             : DDS_RELIABILITY_BEST_EFFORT,
                         DDS_SECS(1));
  ::dds_qset_durability(made, quality.durability == segue::ros2::Durability::TransientLocal
                                  ? DDS_DURABILITY_TRANSIENT_LOCAL
                                  : DDS_DURABILITY_VOLATILE);
  ::dds_qset_history(made, quality.depth == 0 ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST,
                     static_cast<std::int32_t>(std::max(quality.depth, 1U)));
  set_duration(made, quality.deadline, ::dds_qset_deadline);
  ::dds_qset_liveliness(made,
                        quality.liveliness == segue::ros2::Liveliness::Automatic
                            ? DDS_LIVELINESS_AUTOMATIC
                            : DDS_LIVELINESS_MANUAL_BY_TOPIC,
                        quality.lease.count() > 0 ? quality.lease.count() : DDS_INFINITY);
  const dds_data_representation_id_t xcdr1 = DDS_DATA_REPRESENTATION_XCDR1;
  ::dds_qset_data_representation(made, 1, &xcdr1);
  ::dds_qset_userdata(made, user_data.data(), user_data.size());
  return made;
}

Gid gid_of(dds_entity_t entity) {
  dds_guid_t guid{};
  ::dds_get_guid(entity, &guid);
  Gid gid{};
  std::copy(std::begin(guid.v), std::end(guid.v), gid.begin());
  return gid;
}

/// An endpoint with its topic.
struct Channel {
  Channel(dds_entity_t participant, const std::string& name, const std::string& type)
      : topic(participant, name, type) {}
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;
  ~Channel() { ::dds_delete(entity); }

  void write(const Bytes& bytes) const {
    auto* message = new gateway::Message(topic.type(), SDK_DATA, bytes.size());
    std::ranges::copy(bytes, message->bytes().begin());
    if (::dds_writecdr(entity, message) != DDS_RETCODE_OK) std::fprintf(stderr, "the peer cannot write\n");
  }
  [[nodiscard]] std::vector<Bytes> take() const {
    std::vector<Bytes> all;
    std::array<ddsi_serdata*, 16> messages{};
    std::array<dds_sample_info_t, 16> infos{};
    for (dds_return_t taken = 16; taken == 16;) {
      taken = ::dds_takecdr(entity, messages.data(), 16, infos.data(), DDS_ANY_STATE);
      for (std::size_t i = 0; taken > 0 && i < static_cast<std::size_t>(taken); ++i) {
        const gateway::MessageRef message(static_cast<gateway::Message*>(messages.at(i)));
        if (infos.at(i).valid_data) all.emplace_back(message->bytes().begin(), message->bytes().end());
      }
    }
    return all;
  }

  gateway::Topic topic;
  dds_entity_t entity = 0;
};

class CyclonePeer final : public Peer {
 public:
  explicit CyclonePeer(std::uint32_t domain, bool before_iron = false) : Peer(before_iron) {
    open_domain(domain);
    dds_qos_t* quality = ::dds_create_qos();
    const std::string user_data = "enclave=/;";
    ::dds_qset_userdata(quality, user_data.data(), user_data.size());
    participant_ = ::dds_create_participant(domain, quality, nullptr);
    ::dds_delete_qos(quality);
    Quality latched;
    latched.durability = segue::ros2::Durability::TransientLocal;
    latched.depth = 1;
    entities_out_ = make(true, {"", "", entities_hash(), latched}, "ros_discovery_info", kEntitiesType);
    latched.depth = 0;
    entities_in_ = make(false, {"", "", entities_hash(), latched}, "ros_discovery_info", kEntitiesType);
  }
  ~CyclonePeer() override {
    more_.clear();
    out_.reset();
    in_.reset();
    stop_serving();
    asks_.reset();
    answers_.reset();
    entities_out_.reset();
    entities_in_.reset();
    ::dds_delete(participant_);
  }

  void advertise(const TopicOf& topic) override {
    out_.reset();
    out_ = make(true, topic, segue::ros2::dds_topic_name(topic.topic).value(),
                segue::ros2::dds_type_name(topic.interface));
  }
  void subscribe(const TopicOf& topic) override {
    in_.reset();
    in_ = make(false, topic, segue::ros2::dds_topic_name(topic.topic).value(),
               segue::ros2::dds_type_name(topic.interface));
  }
  void announce(const std::string& node) override {
    segue::ros2::NodeEntities entities{"/", node, {}, {}};
    if (in_) entities.subscriptions.push_back(gid_of(in_->entity));
    if (out_) entities.publishers.push_back(gid_of(out_->entity));
    if (requests_) entities.subscriptions.push_back(gid_of(requests_->entity));
    if (responses_) entities.publishers.push_back(gid_of(responses_->entity));
    entities_out_->write(segue::ros2::encode({own_gid(), {entities}, is_before_iron()}));
  }
  void say(const Bytes& entities) override { entities_out_->write(entities); }
  void advertise_more(const TopicOf& topic, std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) {
      more_.push_back(make(true, topic, segue::ros2::dds_topic_name(topic.topic).value(),
                           segue::ros2::dds_type_name(topic.interface)));
    }
  }
  void publish(const Bytes& message) override { out_->write(message); }
  std::vector<Bytes> take() override { return in_->take(); }
  void serve(const std::string& service, const std::string& interface, const ServiceHashes& hashes) override {
    stop_serving();
    const std::string server = "serviceid=1.2.3.4.5.6.7.8.9.a.b.c.d.e.f.10;";
    requests_ = make(false, {}, segue::ros2::dds_request_name(service).value(),
                     segue::ros2::dds_type_name(interface + "_Request"),
                     server + hash_data(hashes.request, hashes.whole));
    responses_ = make(true, {}, segue::ros2::dds_response_name(service).value(),
                      segue::ros2::dds_type_name(interface + "_Response"),
                      server + hash_data(hashes.response, hashes.whole));
  }
  void stop_serving() override {
    requests_.reset();
    responses_.reset();
  }
  /// After the header of the CDR, a request has eight bytes for the client and eight for its number.
  std::vector<Request> requests() override {
    std::vector<Request> all;
    for (const Bytes& bytes : requests_->take()) {
      if (bytes.size() < 20) continue;
      Request request;
      request.message.assign(bytes.begin(), bytes.begin() + 4);
      request.message.insert(request.message.end(), bytes.begin() + 20, bytes.end());
      std::memcpy(request.client.data(), &bytes[4], 8);
      std::memcpy(&request.number, &bytes[12], 8);
      all.push_back(std::move(request));
    }
    return all;
  }
  void respond(const Request& request, const Bytes& response) override {
    responses_->write(identified(request.client, request.number, response));
  }
  void use(const std::string& service, const std::string& interface) override {
    asks_.reset();
    answers_.reset();
    const std::string client = "clientid=1.2.3.4.5.6.7.8.9.a.b.c.d.e.f.11;";
    answers_ = make(false, {}, segue::ros2::dds_response_name(service).value(),
                    segue::ros2::dds_type_name(interface + "_Response"), client);
    asks_ = make(true, {}, segue::ros2::dds_request_name(service).value(),
                 segue::ros2::dds_type_name(interface + "_Request"), client);
  }
  std::uint32_t servers() override {
    dds_subscription_matched_status_t status{};
    ::dds_get_subscription_matched_status(answers_->entity, &status);
    return std::min(matched(*asks_), status.current_count);
  }
  std::int64_t ask(const Bytes& request) override {
    const std::int64_t number = ++last_number_;
    asks_->write(identified(own_client(), number, request));
    return number;
  }
  std::vector<Response> responses() override {
    std::vector<Response> all;
    for (const Bytes& bytes : answers_->take()) {
      if (bytes.size() < 20 || std::memcmp(&bytes[4], own_client().data(), 8) != 0) continue;
      Response response;
      std::memcpy(&response.number, &bytes[12], 8);
      response.message.assign(bytes.begin(), bytes.begin() + 4);
      response.message.insert(response.message.end(), bytes.begin() + 20, bytes.end());
      all.push_back(std::move(response));
    }
    return all;
  }
  std::uint32_t subscriptions() override { return matched(*out_); }
  std::uint32_t clients() override { return matched(*responses_); }
  std::uint32_t publishers() override {
    dds_subscription_matched_status_t status{};
    ::dds_get_subscription_matched_status(in_->entity, &status);
    return status.current_count;
  }
  std::string user_data_of_publisher() override {
    dds_instance_handle_t handle = 0;
    if (::dds_get_matched_publications(in_->entity, &handle, 1) < 1) return {};
    auto* endpoint = ::dds_get_matched_publication_data(in_->entity, handle);
    void* data = nullptr;
    std::size_t size = 0;
    ::dds_qget_userdata(endpoint->qos, &data, &size);
    std::string text(static_cast<const char*>(data), size);
    ::dds_free(data);
    ::dds_builtintopic_free_endpoint(endpoint);
    return text;
  }

 private:
  [[nodiscard]] Gid own_gid() const override { return gid_of(participant_); }
  std::vector<Bytes> take_entities() override { return entities_in_->take(); }
  static Bytes identified(const Gid& client, std::int64_t number, const Bytes& message) {
    Bytes bytes(20);
    std::copy_n(message.begin(), 4, bytes.begin());
    std::memcpy(&bytes[4], client.data(), 8);
    std::memcpy(&bytes[12], &number, 8);
    bytes.insert(bytes.end(), message.begin() + 4, message.end());
    return bytes;
  }
  /// Of which eight bytes are used.
  [[nodiscard]] Gid own_client() const {
    Gid client = gid_of(participant_);
    std::rotate(client.begin(), client.begin() + 4, client.end());
    return client;
  }
  static std::uint32_t matched(const Channel& channel) {
    dds_publication_matched_status_t status{};
    ::dds_get_publication_matched_status(channel.entity, &status);
    return status.current_count;
  }
  [[nodiscard]] std::unique_ptr<Channel> make(bool publishes, const TopicOf& topic, const std::string& name,
                                              const std::string& type,
                                              const std::string& more_user_data = "") const {
    auto channel = std::make_unique<Channel>(participant_, name, type);
    dds_qos_t* quality = quality_of(topic.quality, more_user_data + hash_data(topic.hash));
    channel->entity = publishes
                          ? ::dds_create_writer(participant_, channel->topic.entity(), quality, nullptr)
                          : ::dds_create_reader(participant_, channel->topic.entity(), quality, nullptr);
    ::dds_delete_qos(quality);
    if (channel->entity < 0) std::abort();
    return channel;
  }

  dds_entity_t participant_ = 0;
  std::unique_ptr<Channel> entities_out_;
  std::unique_ptr<Channel> entities_in_;
  std::vector<std::unique_ptr<Channel>> more_;
  std::unique_ptr<Channel> out_;
  std::unique_ptr<Channel> in_;
  std::unique_ptr<Channel> requests_;
  std::unique_ptr<Channel> responses_;
  std::unique_ptr<Channel> asks_;
  std::unique_ptr<Channel> answers_;
  std::int64_t last_number_ = 0;
};

}  // namespace

std::unique_ptr<Peer> make_cyclone_peer_before_iron(std::uint32_t domain) {
  return std::make_unique<CyclonePeer>(domain, true);
}

std::unique_ptr<Peer> make_cyclone_peer(std::uint32_t domain) {
  return std::make_unique<CyclonePeer>(domain);
}

}  // namespace ros2::testing
