// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "participant.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/quality.hpp>
#include <segue/type/value.hpp>

#include <fastdds/dds/publisher/DataWriterListener.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace ros2 {

/// Publishes messages of one interface that are made of values, now and then. Any thread.
class MessageWriter final : private dds::DataWriterListener {
 public:
  /// `topic`: "/rosout". Fails as MessageCodec::of() and Participant::make_writer().
  static segue::Result<std::unique_ptr<MessageWriter>> make(const std::shared_ptr<Participant>& participant,
                                                            segue::ros2::InterfaceLibrary& library,
                                                            const std::string& topic,
                                                            const std::string& interface,
                                                            const segue::ros2::Quality& quality);
  /// Drops what is no message of the interface.
  void publish(const segue::type::Value& message);
  /// Whether there are subscriptions.
  [[nodiscard]] bool is_read() const { return readers_ > 0; }
  /// `changed` is called in a thread of Fast DDS after is_read() may have changed, in place of an earlier
  /// one; it must not call Fast DDS. Once this returns, the earlier one is not called any more.
  void watch(std::function<void()> changed);
  [[nodiscard]] segue::ros2::Gid gid() const { return gid_of(writer_->guid()); }

 private:
  MessageWriter(std::shared_ptr<Participant> participant, segue::ros2::MessageCodec codec)
      : participant_(std::move(participant)), codec_(std::move(codec)) {}
  void on_publication_matched(dds::DataWriter* writer, const dds::PublicationMatchedStatus& status) override;

  const std::shared_ptr<Participant> participant_;
  const segue::ros2::MessageCodec codec_;
  std::atomic<std::int32_t> readers_{0};
  segue::Mutex mutex_;
  std::function<void()> changed_ SEGUE_GUARDED_BY(mutex_);
  Participant::Owned<dds::DataWriter> writer_;  ///< last: it has this called
};

/// As builtin_interfaces/msg/Time.
segue::type::Value time_message(std::chrono::system_clock::time_point time);

}  // namespace ros2
