// SPDX-License-Identifier: Apache-2.0
#include "participant.hpp"

#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>

#include <dds/ddsrt/log.h>

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string_view>

namespace gateway {
namespace {

constexpr std::int32_t kLargestDomain = 232;  // the ports of larger ones do not exist
/// The largest datagrams that UDP has: each costs a system call and a wake-up, of which a sample of 10 MB
/// needs 160 instead of 7500 of the size of an Ethernet frame. The network layer divides them there.
constexpr std::string_view kMessageSize = "65500B";
constexpr std::string_view kFragmentSize = "65000B";
/// How many processes of a host are looked for where multicast is not used.
constexpr int kProcesses = 32;
constexpr std::string_view kUserData = "enclave=/;";  // as ROS 2's participants have

using segue::escape_markup;

bool is_address(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return ::inet_pton(AF_INET, text.c_str(), address.data()) == 1 ||
         ::inet_pton(AF_INET6, text.c_str(), address.data()) == 1;
}

std::string element(std::string_view name, std::string_view content) {
  return "<" + std::string(name) + ">" + std::string(content) + "</" + std::string(name) + ">";
}

std::string interfaces(const std::string& interface) {
  if (interface.empty()) return {};
  const std::string key = is_address(interface) ? "address" : "name";
  return element("Interfaces", "<NetworkInterface " + key + "=\"" + escape_markup(interface) + "\"/>");
}

std::string discovery(const std::vector<std::string>& peers) {
  std::string list;
  for (const std::string& peer : peers)
    list += "<Peer Address=\"" + escape_markup(peer) + "\"/>";
  const std::string all = list.empty() ? std::string() : element("Peers", list);
  return element("Discovery", all + element("ParticipantIndex", "auto") +
                                  element("MaxAutoParticipantIndex", std::to_string(kProcesses - 1)) +
                                  element("LeaseDuration", std::to_string(kLeaseSeconds) + "s"));
}

std::string general(const Settings& settings) {
  return element("General", interfaces(settings.interface) +
                                element("AllowMulticast", settings.peers.empty() ? "true" : "false") +
                                element("MaxMessageSize", kMessageSize) +
                                element("FragmentSize", kFragmentSize));
}

/// The defaults are not made for large samples. The system limits the buffers of sockets (net.core.rmem_max);
/// fragments that find them full are asked for soon, and sent again as many as are missing. Heartbeats ask
/// for acknowledgements, which a Sender of a buffer waits for before it stops; at Cyclone's own 100 ms that
/// would be most of what a switch takes. There are none while nothing is to be acknowledged.
std::string internal() {
  constexpr std::string_view kSocketBuffers =
      "<SocketReceiveBufferSize min=\"default\" max=\"16MiB\"/>"
      "<SocketSendBufferSize min=\"default\" max=\"16MiB\"/>";
  return element("Internal", std::string(kSocketBuffers) + element("NackDelay", "10ms") +
                                 element("HeartbeatInterval", "20ms") +
                                 element("MaxQueuedRexmitBytes", "64MiB") +
                                 element("MaxQueuedRexmitMessages", "4096"));
}

/// Collects the messages of Cyclone while the participant is created; afterwards they go to the log.
class Words {
 public:
  static Words& instance() {
    static auto& words = *new Words;
    return words;
  }
  void listen() { ::dds_set_log_sink(&Words::hear, this); }
  std::string take() {
    const segue::Lock lock(mutex_);
    return std::exchange(heard_, {});
  }
  void log_from_now_on() {
    const segue::Lock lock(mutex_);
    logs_ = true;
  }

 private:
  static void hear(void* self, const dds_log_data_t* line) {
    std::string_view text(line->message, line->size);
    while (!text.empty() && (text.back() == '\n' || text.back() == '\0'))
      text.remove_suffix(1);
    static_cast<Words*>(self)->add(text);
  }
  void add(std::string_view text) {
    const segue::Lock lock(mutex_);
    if (logs_) return segue::log(segue::LogLevel::Warning, "gateway", text);
    if (!heard_.empty()) heard_ += "; ";
    heard_ += text;
  }

  segue::Mutex mutex_;
  std::string heard_ SEGUE_GUARDED_BY(mutex_);
  bool logs_ SEGUE_GUARDED_BY(mutex_) = false;
};

struct Shared {
  segue::Mutex mutex;
  std::optional<Settings> settings SEGUE_GUARDED_BY(mutex);
  dds_entity_t domain SEGUE_GUARDED_BY(mutex) = 0;
  dds_entity_t participant SEGUE_GUARDED_BY(mutex) = 0;

  ~Shared() {
    // Tells the others, which would wait for the lease otherwise.
    if (domain > 0) ::dds_delete(domain);
  }
};

Shared& shared() {
  static Shared instance;
  return instance;
}

std::string to_string(const Settings& settings) {
  return "domain " + std::to_string(settings.domain) + ", interface " +
         (settings.interface.empty() ? "of Cyclone's choice" : segue::quote(settings.interface)) + ", " +
         (settings.peers.empty() ? "multicast" : "peers " + segue::listed(settings.peers));
}

segue::Result<void> check(const Settings& settings) {
  if (settings.domain < 0 || settings.domain > kLargestDomain) {
    return segue::fail(segue::ErrorCode::InvalidArgument, "domain " + std::to_string(settings.domain) +
                                                              " does not exist; choose one of 0 to " +
                                                              std::to_string(kLargestDomain));
  }
  if (std::ranges::find(settings.peers, std::string()) != settings.peers.end())
    return segue::fail(segue::ErrorCode::InvalidArgument, "a peer without an address");
  return {};
}

dds_entity_t create_participant(const Settings& settings) {
  dds_qos_t* quality = ::dds_create_qos();
  ::dds_qset_userdata(quality, kUserData.data(), kUserData.size());
  const dds_entity_t made =
      ::dds_create_participant(static_cast<dds_domainid_t>(settings.domain), quality, nullptr);
  ::dds_delete_qos(quality);
  return made;
}

/// Requires the lock.
segue::Result<dds_entity_t> create(Shared& all, const Settings& settings) SEGUE_REQUIRES(all.mutex) {
  Words& words = Words::instance();
  words.listen();
  static_cast<void>(words.take());
  const auto refuse = [&](dds_return_t code) {
    const std::string said = words.take();
    return segue::fail(segue::ErrorCode::Unavailable,
                       "Cyclone DDS cannot start (" + to_string(settings) +
                           "): " + (said.empty() ? ::dds_strretcode(code) : said));
  };
  const dds_entity_t domain =
      ::dds_create_domain(static_cast<dds_domainid_t>(settings.domain), configuration(settings).c_str());
  if (domain < 0) return refuse(domain);
  const dds_entity_t made = create_participant(settings);
  if (made < 0) {
    ::dds_delete(domain);
    return refuse(made);
  }
  all.domain = domain;
  all.participant = made;
  all.settings = settings;
  if (const std::string said = words.take(); !said.empty())
    segue::log(segue::LogLevel::Warning, "gateway", said);
  words.log_from_now_on();
  return made;
}

}  // namespace

std::string configuration(const Settings& settings) {
  return "<CycloneDDS><Domain Id=\"any\">" + general(settings) + discovery(settings.peers) + internal() +
         element("SharedMemory", element("Enable", "false")) + "</Domain></CycloneDDS>";
}

std::vector<std::string> peers_of_process() {
  const char* variable = std::getenv("SEGUE_PEERS");
  std::vector<std::string> peers;
  std::stringstream list(variable == nullptr ? "" : variable);
  for (std::string peer; std::getline(list, peer, ',');)
    peers.push_back(peer);
  return peers;
}

segue::Result<dds_entity_t> participant(const Settings& settings) {
  if (auto valid = check(settings); !valid) return valid.error();
  Shared& all = shared();
  const segue::Lock lock(all.mutex);
  if (all.participant == 0) return create(all, settings);
  if (*all.settings == settings) return all.participant;
  return segue::fail(segue::ErrorCode::InvalidState,
                     "this process already takes part in DDS with other settings (" +
                         to_string(*all.settings) + ") than this task's (" + to_string(settings) +
                         "); give all link tasks of a process the same");
}

segue::Error dds_error(const std::string& what, dds_return_t code) {
  const auto kind = code == DDS_RETCODE_OUT_OF_RESOURCES ? segue::ErrorCode::ResourceExhausted
                                                         : segue::ErrorCode::Unavailable;
  return segue::fail(kind, what + ": " + ::dds_strretcode(code));
}

std::uint64_t count_other_types(dds_entity_t participant, const std::string& topic, const std::string& type,
                                bool writers) {
  constexpr std::size_t kBatch = 64;
  const dds_entity_t list = writers ? DDS_BUILTIN_TOPIC_DCPSPUBLICATION : DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION;
  // A new reader finds all endpoints that exist now.
  const dds_entity_t reader = ::dds_create_reader(participant, list, nullptr, nullptr);
  std::uint64_t count = 0;
  std::array<void*, kBatch> samples{};
  std::array<dds_sample_info_t, kBatch> infos{};
  for (dds_return_t taken = 1; taken > 0;) {
    taken = ::dds_take(reader, samples.data(), infos.data(), kBatch, kBatch);
    for (std::size_t i = 0; taken > 0 && i < static_cast<std::size_t>(taken); ++i) {
      const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      if (infos[i].valid_data && topic == endpoint->topic_name && type != endpoint->type_name) ++count;
    }
    if (taken > 0) ::dds_return_loan(reader, samples.data(), taken);
  }
  ::dds_delete(reader);
  return count;
}

}  // namespace gateway
