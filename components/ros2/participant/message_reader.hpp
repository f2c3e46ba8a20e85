// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "opaque_type.hpp"
#include "participant.hpp"

#include <segue/base/result.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/quality.hpp>

#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <functional>
#include <new>
#include <span>
#include <string>
#include <utility>

namespace ros2 {

/// Takes the messages of a topic in the thread in which Fast DDS receives them.
class MessageReader final : private dds::DataReaderListener, private MessageSink {
 public:
  /// `take` gets the CDR of each.
  explicit MessageReader(std::function<void(std::span<const std::byte>)> take) : take_(std::move(take)) {}

  /// `topic`: "/fibonacci/_action/feedback". Fails as Participant::make_reader().
  segue::Result<void> open(Participant& participant, const std::string& topic,
                           const segue::ros2::MessageCodec& message, const segue::ros2::Quality& quality);
  [[nodiscard]] segue::ros2::Gid gid() const { return gid_of(reader_->guid()); }

 private:
  void on_data_available(dds::DataReader* reader) override;
  bool take(std::span<const std::byte> message) noexcept override;

  const std::function<void(std::span<const std::byte>)> take_;
  Participant::Owned<dds::DataReader> reader_;
};

}  // namespace ros2
