// SPDX-License-Identifier: Apache-2.0
#include "topic_reader.hpp"

#include <segue/ros2/dds_names.hpp>

#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <new>
#include <utility>

namespace ros2 {

using segue::ros2::Gid;

segue::Result<std::unique_ptr<TopicReader>> TopicReader::make(const std::shared_ptr<Participant>& participant,
                                                              segue::ros2::InterfaceLibrary& library,
                                                              const TopicSettings& settings, TopicPort port) {
  auto facts = check(settings, false, library);
  if (!facts) return facts.error();
  std::unique_ptr<TopicReader> made(new TopicReader(participant, std::move(port), std::move(*facts)));
  if (auto opened = made->open(); !opened) return opened.error();
  return made;
}

TopicReader::TopicReader(std::shared_ptr<Participant> participant, TopicPort port, Facts facts)
    : TopicEndpoint(std::move(participant), std::move(port), std::move(facts)),
      out_(port_facts().component, this->port(), codec(), port_facts().doc, topic_of_port(),
           [this] { begin(); }) {}

segue::Result<void> TopicReader::open() {
  auto reader = participant().make_reader(topic_name(), quality(), user_data(), this);
  if (!reader) return reader.error();
  reader_ = std::move(*reader);
  watch();
  return {};
}

TopicReader::~TopicReader() {
  stop_watching();
  reader_.reset();
}

void TopicReader::start() {
  const segue::Lock lock(mutex_);
  running_ = true;
  has_sample_ = false;
  deliver_waiting();
}

/// In the thread that has committed the transition.
void TopicReader::begin() {
  const segue::Lock lock(mutex_);
  if (running_) deliver_waiting();
}

/// Where the connections of the port begin with a commit, that is when they have.
void TopicReader::deliver_waiting() noexcept {
  delivers_ = delivers_ || !out_.dormant();
  if (!delivers_) return;
  for (const Message& message : waiting_) {
    Arrival arrival{.size = message.size()};
    arrival.sample = out_.make(message, arrival.why);
    deliver(arrival);
  }
  waiting_.clear();
}

void TopicReader::stop() {
  const segue::Lock lock(mutex_);
  running_ = false;
  delivers_ = false;
}

bool TopicReader::has_sample() const {
  const segue::Lock lock(mutex_);
  return has_sample_;
}

/// In a thread of Fast DDS, which holds locks of its own: nothing that has our lock calls Fast DDS.
void TopicReader::on_data_available(dds::DataReader* reader) {
  dds::SampleInfo info;
  while (reader->take_next_sample(static_cast<MessageSink*>(this), &info) == ReturnCode_t::RETCODE_OK) {
    if (info.valid_data) pass(gid_of(info.sample_identity.writer_guid()));
  }
}

bool TopicReader::take(std::span<const std::byte> message) noexcept {
  const segue::Lock lock(mutex_);
  arrival_ = {.size = message.size()};
  if (running_) {
    if (!delivers_) deliver_waiting();
    arrival_.sample = out_.make(message, arrival_.why);
  }
  if (!delivers_ && quality().durability == segue::ros2::Durability::TransientLocal) {
    try {
      arrival_.message.assign(message.begin(), message.end());
    } catch (const std::bad_alloc&) {
      ++counts_.lost;
    }
  }
  return true;
}

void TopicReader::pass(const Gid& writer) noexcept {
  const segue::Lock lock(mutex_);
  if (is_foreign(writer)) {
    ++counts_.foreign;
  } else if (!delivers_) {
    ++counts_.early;
    if (arrival_.sample) has_sample_ = true;
    if (!arrival_.message.empty()) keep(std::move(arrival_.message));
  } else {
    // Where the task has been started meanwhile, it is not decoded yet.
    if (!arrival_.sample && !arrival_.message.empty())
      arrival_.sample = out_.make(arrival_.message, arrival_.why);
    deliver(arrival_);
  }
  arrival_ = {};
}

void TopicReader::keep(Message message) noexcept {
  try {
    waiting_.push_back(std::move(message));
    if (waiting_.size() > std::max(quality().depth, 1U)) waiting_.pop_front();
  } catch (const std::bad_alloc&) {
    ++counts_.lost;
  }
}

void TopicReader::deliver(Arrival& arrival) noexcept {
  auto outcome = arrival.why;
  if (arrival.sample) outcome = out_.publish(std::move(arrival.sample));
  if (outcome == CdrOutput::Outcome::Lost) {
    ++counts_.lost;
  } else if (outcome == CdrOutput::Outcome::Corrupt) {
    ++counts_.corrupt;
  } else {
    has_sample_ = true;
    ++counts_.received;
    counts_.bytes += arrival.size;
    if (outcome == CdrOutput::Outcome::Refused) ++counts_.refused;
  }
}

bool TopicReader::is_foreign(const Gid& writer) const noexcept {
  // Of this process are publishers of Segue's own tasks only, which may pass on what this port has sent.
  return !port_facts().node.empty() && (segue::ros2::same_participant(writer, participant().gid()) ||
                                        std::ranges::binary_search(foreign_, writer));
}

std::vector<std::pair<Gid, std::string>> TopicReader::find_foreign() const {
  std::vector<std::pair<Gid, std::string>> found;
  if (port_facts().node.empty()) return found;
  const auto& graph = participant().graph();
  for (const auto& endpoint : graph.endpoints(topic_name().topic, true)) {
    std::string node = graph.node_of(endpoint.gid);
    if (!node.empty() && node != port_facts().node) found.emplace_back(endpoint.gid, std::move(node));
  }
  return found;
}

void TopicReader::changed() {
  std::vector<Gid> foreign;
  for (const auto& [gid, node] : find_foreign())
    foreign.push_back(gid);
  std::ranges::sort(foreign);
  {
    const segue::Lock lock(mutex_);
    foreign_.swap(foreign);
  }
  TopicEndpoint::changed();
}

/// Several nodes may well have the same topic; it is odd only where this one has not.
std::vector<segue::ros2::Mismatch> TopicReader::find_mismatches() const {
  auto found = TopicEndpoint::find_mismatches();
  const auto foreign = find_foreign();
  const auto& graph = participant().graph();
  const auto all = graph.endpoints(topic_name().topic, true);
  const bool is_published = std::ranges::any_of(
      all, [&](const auto& endpoint) { return graph.node_of(endpoint.gid) == port_facts().node; });
  if (is_published) return found;
  for (const auto& [gid, node] : foreign) {
    if (found.size() >= segue::ros2::NodeGraph::kMostMismatches) break;
    found.push_back({"node " + node + " publishes " + topic() + ", but port " + port() +
                     " carries what node " + port_facts().node + " publishes"});
  }
  return found;
}

SubscriptionStatistics TopicReader::statistics() const {
  segue::Lock lock(mutex_);
  SubscriptionStatistics now = counts_;
  lock.unlock();
  now.missed = missed();
  now.matched = matched();
  now.mismatched = static_cast<std::uint32_t>(find_mismatches().size());
  return now;
}

void TopicReader::on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) {
  set_matched(status.current_count);
}

void TopicReader::on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) {
  const segue::Lock lock(mutex_);
  counts_.lost += static_cast<std::uint64_t>(std::max(status.total_count_change, 0));
}

void TopicReader::on_requested_deadline_missed(dds::DataReader*,
                                               const dds::RequestedDeadlineMissedStatus& status) {
  missed("the deadline was missed", status.total_count_change);
}

void TopicReader::on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) {
  missed("liveliness was lost", static_cast<std::uint32_t>(std::max(status.not_alive_count_change, 0)));
}

}  // namespace ros2
