// SPDX-License-Identifier: Apache-2.0
#include "topic_ports.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/node_topics.hpp>
#include <segue/type/describe.hpp>

#include <algorithm>
#include <chrono>
#include <thread>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;
using segue::Result;
using segue::type::Value;

/// "publishes.scan: topic ..." in place of "topic ...".
segue::Error at(const char* property, const std::string& port, segue::Error error) {
  error.message = std::string(property) + "." + port + ": " + error.message;
  return error;
}

template <class Endpoint>
Result<void> make_all(
    std::vector<std::unique_ptr<Endpoint>>& made, const TopicMap& topics,
    const std::function<Result<std::unique_ptr<Endpoint>>(const std::string&, const TopicSettings&)>& make) {
  for (const auto& [port, settings] : topics) {
    auto one = make(port, settings);
    if (!one) return at(Endpoint::kPublishes ? "subscribes" : "publishes", port, std::move(one.error()));
    made.push_back(std::move(*one));
  }
  return {};
}

std::string why_nothing_comes(const TopicReader& reader) {
  if (const auto reasons = reader.mismatches(); !reasons.empty()) return segue::listed(reasons);
  const SubscriptionStatistics counts = reader.statistics();
  if (counts.matched == 0) return "nobody publishes " + reader.topic();
  return counts.corrupt > 0 ? "what comes on " + reader.topic() + " is not of its type"
                            : "nothing comes on " + reader.topic();
}

}  // namespace

Result<TopicMap> read_topics(const Value& topics, std::string_view path) {
  if (!topics.is_map()) {
    return fail(ErrorCode::InvalidArgument, std::string(path) +
                                                ": expected a map from ports to topics, such as {scan: "
                                                "sensor_msgs/msg/LaserScan}");
  }
  TopicMap all;
  const auto& type = segue::type::type_info<TopicSettings>();
  for (const auto& [port, entry] : topics.as_map()) {
    const std::string place = std::string(path) + "." + port;
    if (!segue::is_identifier(port))
      return fail(ErrorCode::InvalidArgument, place + ": " + quote(port) + " is not a valid name of a port");
    auto settings = segue::ros2::topic_settings(port, entry, place);
    if (!settings) return settings.error();
    if (auto read = type.from_value(&all[port], *settings, place); !read) return read.error();
  }
  return all;
}

Result<void> TopicPorts::check(const Wanted& wanted) {
  for (const auto& [port, settings] : wanted.publishes) {
    const bool is_twice = wanted.subscribes.contains(port);
    if (port == "state" || is_twice) {
      return fail(ErrorCode::InvalidArgument,
                  "publishes." + port + ": " +
                      (is_twice ? "the name is in subscribes, too" : "every task has a port of that name") +
                      "; choose another one");
    }
  }
  std::vector<std::string> names;
  for (const auto& [port, settings] : wanted.publishes)
    names.push_back(port);
  for (const std::string& port : wanted.ready) {
    if (wanted.publishes.contains(port)) continue;
    return fail(ErrorCode::InvalidArgument, "ready: publishes has no " + quote(port) +
                                                segue::did_you_mean_or_list(port, names, "it has"));
  }
  return {};
}

Result<void> TopicPorts::open(segue::task::Component& component, const std::string& task,
                              const std::string& node, const std::shared_ptr<Participant>& participant,
                              segue::ros2::InterfaceLibrary& library, const Wanted& wanted) {
  auto done = make_all<TopicReader>(
      readers_, wanted.publishes, [&](const std::string& port, const TopicSettings& settings) {
        return TopicReader::make(
            participant, library, settings,
            {component, task, port, "what the node publishes on " + settings.topic, node});
      });
  if (done) {
    done = make_all<TopicWriter>(
        writers_, wanted.subscribes, [&](const std::string& port, const TopicSettings& settings) {
          return TopicWriter::make(
              participant, library, settings,
              {component, task, port, "for the node's subscription to " + settings.topic, node});
        });
  }
  if (!done) close();
  ready_ = wanted.ready;
  return done;
}

void TopicPorts::close() {
  readers_.clear();
  writers_.clear();
}

void TopicPorts::start() {
  for (const auto& reader : readers_)
    reader->start();
}

void TopicPorts::stop() {
  for (const auto& reader : readers_)
    reader->stop();
}

void TopicPorts::send() {
  for (const auto& writer : writers_)
    writer->send();
}

std::vector<const TopicReader*> TopicPorts::missing() const {
  std::vector<const TopicReader*> found;
  for (const auto& reader : readers_) {
    if (std::ranges::find(ready_, reader->port()) != ready_.end() && !reader->has_sample())
      found.push_back(reader.get());
  }
  return found;
}

Result<void> TopicPorts::await_samples(segue::TimePoint deadline,
                                       const std::function<bool()>& gives_up) const {
  constexpr std::chrono::milliseconds kBetweenLooks{10};
  for (auto lacking = missing(); !lacking.empty(); lacking = missing()) {
    if (segue::monotonic_now() < deadline && !gives_up()) {
      std::this_thread::sleep_for(kBetweenLooks);
      continue;
    }
    std::vector<std::string> texts;
    for (const TopicReader* reader : lacking)
      texts.push_back("port " + quote(reader->port()) + " (" + why_nothing_comes(*reader) + ")");
    return fail(ErrorCode::DeadlineExceeded, "no sample has come at " + segue::listed(texts));
  }
  return {};
}

NodeStatistics TopicPorts::statistics() const {
  NodeStatistics all;
  for (const auto& reader : readers_)
    all.publishes.push_back({reader->port(), reader->topic(), reader->statistics()});
  for (const auto& writer : writers_)
    all.subscribes.push_back({writer->port(), writer->topic(), writer->statistics()});
  return all;
}

std::vector<std::string> TopicPorts::mismatches() const {
  std::vector<std::string> all;
  const auto add = [&](const auto& endpoints) {
    for (const auto& endpoint : endpoints) {
      for (std::string& text : endpoint->mismatches())
        all.push_back(std::move(text));
    }
  };
  add(readers_);
  add(writers_);
  return all;
}

std::pair<std::vector<segue::ros2::Gid>, std::vector<segue::ros2::Gid>> TopicPorts::gids() const {
  std::pair<std::vector<segue::ros2::Gid>, std::vector<segue::ros2::Gid>> all;
  for (const auto& writer : writers_)
    all.first.push_back(writer->gid());
  for (const auto& reader : readers_)
    all.second.push_back(reader->gid());
  return all;
}

}  // namespace ros2
