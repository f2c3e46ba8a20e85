// SPDX-License-Identifier: Apache-2.0
#include "topic_reader.hpp"
#include "topic_task.hpp"

#include <memory>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

static segue::Activity in_shared_thread() {
  segue::Activity activity;
  activity.thread = "ros2_subscriptions";
  return activity;
}

/// Writes the samples of a topic of ROS 2 to `out`.
class Subscription final : public TopicTask {
 public:
  Subscription()
      : TopicTask(Direction::Output, "out",
                  {.doc = "Subscribes to a topic of ROS 2", .activity = in_shared_thread()}) {}

 protected:
  segue::Result<void> on_configure() override {
    auto made = open<TopicReader>(settings(), "out", "samples as they arrive");
    if (!made) return made.error();
    reader_ = std::move(*made);
    return {};
  }
  segue::Result<void> on_start() override {
    reader_->start();
    return {};
  }
  void on_update() override {}
  void on_stop() override { reader_->stop(); }
  void on_cleanup() override { close(reader_); }

 private:
  [[nodiscard]] const TopicEndpoint* endpoint() const override { return reader_.get(); }

  Operation<SubscriptionStatistics()> statistics_{
      *this,
      "statistics",
      {},
      [this] { return reader_ == nullptr ? SubscriptionStatistics() : reader_->statistics(); },
      RunsIn::TaskThread,
      "what arrived so far"};
  std::unique_ptr<TopicReader> reader_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::Subscription)
