// SPDX-License-Identifier: Apache-2.0
#include "sample_source.hpp"
#include "topic_endpoint.hpp"

#include <segue/task/any_port.hpp>

#include <fastdds/dds/publisher/DataWriterListener.hpp>

#include <optional>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Publishes what arrives at `in` on a topic of ROS 2. Nothing is sent before the task is started.
class Publisher final : public TopicEndpoint, private dds::DataWriterListener {
 public:
  Publisher()
      : TopicEndpoint(Direction::Input, "in",
                      {.doc = "Publishes samples on a topic of ROS 2", .trigger_on = {"in"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*lifespan_ < std::chrono::nanoseconds(0))
      return segue::fail(segue::ErrorCode::InvalidArgument, "lifespan must not be negative");
    if (auto opened = open(); !opened) return opened;
    counts_ = {};
    segue::ros2::Quality offered = quality();
    offered.lifespan = *lifespan_;
    auto writer = participant().make_writer(topic_name(), offered, user_data(), this);
    if (!writer) {
      leave();
      return writer.error();
    }
    writer_ = std::move(*writer);
    watch(gid_of(writer_->guid()));
    in_.emplace(*this, "in", &codec().info(), std::string(),
                PortOptions{.dynamic = true, .doc = "samples to publish", .flat = true});
    return {};
  }

  void on_update() override {
    // The executor gives another turn if there are more, in between of which the task can be stopped.
    constexpr int kMost = 64;
    for (int i = 0; i < kMost; ++i) {
      const SampleRef sample = in_->take();
      if (!sample) return;
      send(*sample.get());
    }
  }

  void on_cleanup() override {
    stop_watching();
    writer_.reset();
    in_.reset();
    leave();
  }

 private:
  void send(const SampleSlot& sample) {
    SampleSource source(codec(), sample);
    if (sample.value == nullptr || source.size() == 0 ||
        !writer_->write(static_cast<MessageSource*>(&source))) {
      ++counts_.refused;
      return;
    }
    ++counts_.sent;
    counts_.bytes += source.size();
  }

  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override {
    set_matched(status.current_count);
  }
  void on_offered_deadline_missed(dds::DataWriter*, const dds::OfferedDeadlineMissedStatus& status) override {
    missed("the deadline was missed", status.total_count_change);
  }
  void on_liveliness_lost(dds::DataWriter*, const dds::LivelinessLostStatus& status) override {
    missed("liveliness was lost", static_cast<std::uint32_t>(std::max(status.total_count_change, 0)));
  }

  PublisherStatistics statistics() const {
    PublisherStatistics now = counts_;
    now.missed = missed();
    now.matched = matched();
    now.mismatched = mismatched();
    return now;
  }

  Property<std::chrono::nanoseconds> lifespan_{
      *this, "lifespan", {}, {.doc = "how long a sample is worth being delivered; 0: for ever"}};
  Operation<PublisherStatistics()> statistics_{
      *this, "statistics", {}, [this] { return statistics(); }, RunsIn::TaskThread, "what was sent so far"};
  PublisherStatistics counts_;
  std::optional<AnyInput> in_;
  Participant::Owned<dds::DataWriter> writer_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::Publisher)
