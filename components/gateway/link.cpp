// SPDX-License-Identifier: Apache-2.0
#include "link.hpp"
#include "names.hpp"

#include <segue/base/text.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/type_info.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <string_view>

namespace gateway {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;

constexpr std::string_view kStructureKey = "segue=";

std::string structure_of(const segue::type::TypeInfo& type) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text(kStructureKey);
  for (int shift = 60; shift >= 0; shift -= 4)
    text += kDigits[(type.hash >> static_cast<unsigned>(shift)) & 15U];
  return text + ";";
}

std::string user_data(const dds_qos_t* quality) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!::dds_qget_userdata(quality, &data, &size) || data == nullptr) return {};
  std::string text(static_cast<const char*>(data), size);
  ::dds_free(data);
  return text;
}

/// Component libraries stay loaded until the process ends.
segue::Result<void> load(const std::string& library) {
  static segue::Mutex mutex;
  static segue::task_host::LibrarySet libraries;
  const segue::Lock lock(mutex);
  return libraries.load(library);
}

using Endpoint = std::unique_ptr<dds_builtintopic_endpoint_t, decltype(&::dds_builtintopic_free_endpoint)>;

}  // namespace

void Matches::set(std::uint32_t count) {
  const segue::Lock lock(mutex_);
  count_ = count;
  changed_.notify_all();
}

std::uint32_t Matches::count() const {
  const segue::Lock lock(mutex_);
  return count_;
}

std::uint32_t Matches::wait(std::uint32_t count, std::uint32_t timeout_ms) const {
  const segue::Lock lock(mutex_);
  changed_.wait_for(mutex_, std::chrono::milliseconds(timeout_ms),
                    [&]() SEGUE_REQUIRES(mutex_) { return count_ >= count; });
  return count_;
}

Link::Link(segue::task::Direction direction, const std::string& port,
           const segue::task::ComponentOptions& options)
    : Component(options), direction_(direction) {
  dynamic_ports(direction, port, "its type is the property type");
}

segue::Result<segue::Policy> Link::wanted_policy() const {
  const auto* kind = std::ranges::find(segue::kBufferKindNames, *policy_text_);
  if (kind == segue::kBufferKindNames.end()) {
    return fail(ErrorCode::InvalidArgument,
                "policy " + quote(*policy_text_) + " is none of data, buffer and circular_buffer");
  }
  segue::Policy policy;
  policy.kind = static_cast<segue::BufferKind>(kind - segue::kBufferKindNames.begin());
  const bool is_data = policy.kind == segue::BufferKind::Data;
  if (*size_ == 0 || (is_data && *size_ != 1)) {
    return fail(ErrorCode::InvalidArgument,
                is_data ? "policy data holds one sample; leave out size" : "size must be at least 1");
  }
  if (*init_ && !is_data) return fail(ErrorCode::InvalidArgument, "init needs policy data");
  policy.size = *size_;
  policy.init = *init_;
  return policy;
}

segue::Result<const segue::type::TypeInfo*> Link::wanted_type() const {
  if (!library_->empty()) {
    if (auto loaded = load(*library_); !loaded) {
      return fail(ErrorCode::NotFound, "type " + quote(*type_text_) + " needs library " + quote(*library_) +
                                           ", which cannot be loaded")
          .because_of(std::move(loaded.error()));
    }
  }
  if (type_text_->empty()) return nullptr;
  const auto* info = segue::type::find_type_info(*type_text_);
  const std::string where =
      library_->empty() ? "this process; name its library under 'library'" : "library " + quote(*library_);
  if (info == nullptr)
    return fail(ErrorCode::NotFound, "type " + quote(*type_text_) + " is not known to " + where);
  if (segue::type::can_encode_cdr(*info)) return info;
  return fail(ErrorCode::Unsupported, "type " + quote(*type_text_) + " of " + where +
                                          " cannot travel between hosts: a part of it has no structure that "
                                          "CDR can express");
}

segue::Result<void> Link::open() {
  auto policy = wanted_policy();
  if (!policy) return policy.error();
  auto topic_name = dds_topic_name(*topic_text_);
  if (!topic_name) return topic_name.error();
  auto type = wanted_type();
  if (!type) return type.error();
  auto joined = participant({*domain_, *interface_, peers_->empty() ? peers_of_process() : *peers_});
  if (!joined) {
    if (joined.error().code == ErrorCode::Unavailable) exception(segue::to_string(joined.error()));
    return joined.error();
  }
  const std::string type_name = dds_type_name(*type == nullptr ? std::string_view() : (*type)->name());
  Topic topic(*joined, *topic_name, type_name);
  if (topic.entity() < 0) return dds_error("topic " + quote(*topic_name), topic.entity());
  type_ = *type;
  kept_ = *policy;
  topic_ = std::move(topic);
  const segue::Lock lock(names_mutex_);
  participant_ = *joined;
  topic_name_ = *topic_name;
  type_name_ = type_name;
  structure_ = type_ == nullptr ? std::string() : structure_of(*type_);
  return {};
}

void Link::close() {
  topic_ = {};
  matches_.set(0);
}

dds_entity_t Link::participant_entity() const {
  const segue::Lock lock(names_mutex_);
  return participant_;
}

std::string Link::topic_name() const {
  const segue::Lock lock(names_mutex_);
  return topic_name_;
}

Quality Link::quality() const {
  // How long one write waits until what was sent before has been acknowledged. See Sender::write().
  constexpr dds_duration_t kPatience = DDS_MSECS(100);
  Quality made(::dds_create_qos());
  ::dds_qset_reliability(made.get(), DDS_RELIABILITY_RELIABLE, kPatience);
  ::dds_qset_durability(made.get(), kept_.init ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (kept_.kind == segue::BufferKind::Buffer) {
    ::dds_qset_history(made.get(), DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  } else {
    constexpr std::size_t kMost = 1U << 30U;
    ::dds_qset_history(made.get(), DDS_HISTORY_KEEP_LAST,
                       static_cast<std::int32_t>(std::min(kept_.size, kMost)));
  }
  ::dds_qset_writer_data_lifecycle(made.get(), false);
  const segue::Lock lock(names_mutex_);
  if (!structure_.empty()) ::dds_qset_userdata(made.get(), structure_.data(), structure_.size());
  return made;
}

bool Link::differs(const dds_builtintopic_endpoint_t& endpoint) const {
  const std::string theirs = user_data(endpoint.qos);
  const std::size_t begin = theirs.find(kStructureKey);
  const segue::Lock lock(names_mutex_);
  return begin != std::string::npos && !structure_.empty() &&
         theirs.compare(begin, structure_.size(), structure_) != 0;
}

std::uint64_t Link::count_mismatched(dds_entity_t endpoint) const {
  constexpr std::size_t kMost = 256;
  const bool writes = direction_ == segue::task::Direction::Input;
  std::array<dds_instance_handle_t, kMost> handles{};
  const dds_return_t count = writes
                                 ? ::dds_get_matched_subscriptions(endpoint, handles.data(), handles.size())
                                 : ::dds_get_matched_publications(endpoint, handles.data(), handles.size());
  std::uint64_t mismatched = 0;
  for (std::size_t i = 0; count > 0 && i < std::min(static_cast<std::size_t>(count), kMost); ++i) {
    const Endpoint other(writes ? ::dds_get_matched_subscription_data(endpoint, handles[i])
                                : ::dds_get_matched_publication_data(endpoint, handles[i]),
                         &::dds_builtintopic_free_endpoint);
    if (other != nullptr && differs(*other)) ++mismatched;
  }
  segue::Lock lock(names_mutex_);
  const std::string topic = topic_name_;
  const std::string type = type_name_;
  const dds_entity_t joined = participant_;
  lock.unlock();
  return joined == 0 ? 0 : mismatched + count_other_types(joined, topic, type, !writes);
}

}  // namespace gateway
