// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message.hpp"
#include "participant.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/policy.hpp>
#include <segue/task/component.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// Connections between hosts: a Sender on the writer's host and a Receiver on the reader's, joined by a topic
/// of DDS. They run in a process of their own, the gateway, since only this library links Cyclone DDS.
namespace gateway {

struct DeleteQuality {
  void operator()(dds_qos_t* quality) const { ::dds_delete_qos(quality); }
};
using Quality = std::unique_ptr<dds_qos_t, DeleteQuality>;

/// How many endpoints are matched on the other side. Any thread.
class Matches {
 public:
  void set(std::uint32_t count);
  [[nodiscard]] std::uint32_t count() const;
  /// Waits until at least `count` are matched, or for so many milliseconds; returns how many are.
  std::uint32_t wait(std::uint32_t count, std::uint32_t timeout_ms) const;

 private:
  mutable segue::Mutex mutex_;
  mutable segue::ConditionVariable changed_;
  std::uint32_t count_ SEGUE_GUARDED_BY(mutex_) = 0;
};

/// A DDS entity that is deleted with its last callback.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t entity) : entity_(entity) {}
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  ~Entity() { reset(); }
  [[nodiscard]] dds_entity_t get() const { return entity_; }
  void reset(dds_entity_t entity = 0) {
    if (entity_ > 0) ::dds_delete(entity_);
    entity_ = entity;
  }

 private:
  dds_entity_t entity_ = 0;
};

/// The base of Sender and Receiver.
class Link : public segue::task::Component {
 protected:
  /// `direction` of the one dynamic port, named `port`.
  Link(segue::task::Direction direction, const std::string& port,
       const segue::task::ComponentOptions& options);

  /// Reads the properties, loads the library, and joins the topic. Enters Exception where Cyclone cannot
  /// start.
  segue::Result<void> open();
  /// Leaves the topic; the endpoint must have been deleted.
  void close();

  /// nullptr: samples without a value.
  [[nodiscard]] const segue::type::TypeInfo* type() const { return type_; }
  [[nodiscard]] const segue::Policy& policy() const { return kept_; }
  [[nodiscard]] const Topic& topic() const { return topic_; }
  [[nodiscard]] dds_entity_t participant_entity() const;
  [[nodiscard]] std::string topic_name() const;
  [[nodiscard]] Quality quality() const;
  /// Whether an endpoint's user data names another structure of the type than this process knows.
  [[nodiscard]] bool differs(const dds_builtintopic_endpoint_t& endpoint) const;
  /// Endpoints of the other side that have the topic but not the type: its name, or its structure. For
  /// people.
  [[nodiscard]] std::uint64_t count_mismatched(dds_entity_t endpoint) const;

  Matches& matches() { return matches_; }
  [[nodiscard]] std::uint64_t matched() const { return matches_.count(); }

 private:
  [[nodiscard]] segue::Result<segue::Policy> wanted_policy() const;
  segue::Result<const segue::type::TypeInfo*> wanted_type() const;

  segue::task::Property<std::string> topic_text_{
      *this, "topic", {}, {.doc = "name of the topic, without rt/"}};
  segue::task::Property<std::string> type_text_{
      *this, "type", {}, {.doc = "type of the samples; empty: samples without a value"}};
  segue::task::Property<std::string> library_{
      *this, "library", {}, {.doc = "component library that has the type; empty: this process has it"}};
  segue::task::Property<std::string> policy_text_{
      *this, "policy", "data", {.doc = "data, buffer or circular_buffer"}};
  segue::task::Property<std::uint32_t> size_{*this, "size", 1, {.doc = "samples that a buffer holds"}};
  segue::task::Property<bool> init_{
      *this, "init", false, {.doc = "data only: a reader that comes later gets the last sample"}};
  segue::task::Property<std::int32_t> domain_{*this, "domain", 0, {.doc = "DDS domain, 0 to 232"}};
  segue::task::Property<std::string> interface_{
      *this, "interface", {}, {.doc = "name or address of the network interface; empty: Cyclone's choice"}};
  segue::task::Property<std::vector<std::string>> peers_{
      *this, "peers", {}, {.doc = "addresses of the other hosts; empty: those in $SEGUE_PEERS"}};
  segue::task::Operation<std::uint32_t()> matched_{*this,
                                                   "matched",
                                                   {},
                                                   [this] { return matches_.count(); },
                                                   segue::task::RunsIn::CallerThread,
                                                   "the number of endpoints on the other side"};
  segue::task::Operation<std::uint32_t(std::uint32_t, std::uint32_t)> wait_matched_{
      *this,
      "wait_matched",
      {"count", "timeout_ms"},
      [this](std::uint32_t count, std::uint32_t timeout_ms) { return matches_.wait(count, timeout_ms); },
      segue::task::RunsIn::CallerThread,
      "waits for so many endpoints on the other side, and returns how many there are"};

  const segue::task::Direction direction_;
  Matches matches_;
  const segue::type::TypeInfo* type_ = nullptr;
  segue::Policy kept_;
  Topic topic_;
  mutable segue::Mutex names_mutex_;  ///< statistics() reads its members in any thread
  dds_entity_t participant_ SEGUE_GUARDED_BY(names_mutex_) = 0;
  std::string topic_name_ SEGUE_GUARDED_BY(names_mutex_);
  std::string type_name_ SEGUE_GUARDED_BY(names_mutex_);
  std::string structure_
      SEGUE_GUARDED_BY(names_mutex_);  ///< in the user data of endpoints; empty without a type
};

}  // namespace gateway
