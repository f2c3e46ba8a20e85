// SPDX-License-Identifier: Apache-2.0
#include "topic_task.hpp"
#include "topic_writer.hpp"

#include <chrono>
#include <memory>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Publishes what arrives at `in` on a topic of ROS 2. Nothing is sent before the task is started.
class Publisher final : public TopicTask {
 public:
  Publisher()
      : TopicTask(Direction::Input, "in",
                  {.doc = "Publishes samples on a topic of ROS 2", .trigger_on = {"in"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    TopicSettings offered = settings();
    offered.lifespan = *lifespan_;
    auto made = open<TopicWriter>(offered, "in", "samples to publish");
    if (!made) return made.error();
    writer_ = std::move(*made);
    return {};
  }
  void on_update() override { writer_->send(); }
  void on_cleanup() override { close(writer_); }

 private:
  [[nodiscard]] const TopicEndpoint* endpoint() const override { return writer_.get(); }

  Property<std::chrono::nanoseconds> lifespan_{
      *this, "lifespan", {}, {.doc = "how long a sample is worth being delivered; 0: for ever"}};
  Operation<PublisherStatistics()> statistics_{
      *this,
      "statistics",
      {},
      [this] { return writer_ == nullptr ? PublisherStatistics() : writer_->statistics(); },
      RunsIn::TaskThread,
      "what was sent so far"};
  std::unique_ptr<TopicWriter> writer_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::Publisher)
