// SPDX-License-Identifier: Apache-2.0
#include "../participant/node_task.hpp"
#include "../participant/types.hpp"
#include "../topics/cdr_output.hpp"
#include "../topics/sample_handover.hpp"
#include "../topics/sample_source.hpp"
#include "responder.hpp"

#include <segue/concurrent/thread.hpp>
#include <segue/task/any_port.hpp>
#include <segue/task/operation.hpp>

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <thread>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

static segue::Activity in_shared_servers() {
  segue::Activity activity;
  activity.thread = "ros2_servers";
  return activity;
}

/// Serves a service of ROS 2: requests go out at `request`, one at a time, and the next sample at `response`
/// answers it. Requests are written and responses sent by a thread of its own, since a client may have to be
/// waited for; an update only hands it the response.
class ServiceServer final : public NodeTask {
 public:
  ServiceServer()
      : NodeTask({.doc = "Serves a service of ROS 2",
                  .activity = in_shared_servers(),
                  .trigger_on = {"response"}}) {
    dynamic_ports(Direction::Output, "request", "its type is of the property type");
    dynamic_ports(Direction::Input, "response", "its type is of the property type");
  }

 protected:
  segue::Result<void> on_configure() override {
    if (*timeout_ <= std::chrono::nanoseconds(0))
      return segue::fail(segue::ErrorCode::InvalidArgument, "timeout must be positive");
    if (auto joined = join(); !joined) return joined;
    auto interfaces = library();
    auto made = Responder::make(
        shared_participant(), interfaces, *service_, *type_,
        [this](const Caller& caller, std::vector<std::byte> request) { take(caller, std::move(request)); });
    if (auto opened = waker_.open(); made && !opened) made = opened.error();
    if (!made) {
      leave();
      return made.error();
    }
    responder_ = std::move(*made);
    request_.emplace(*this, "request", responder_->request(), "requests, one at a time", std::string(),
                     [this] { waker_.wake(); });
    response_.emplace(*this, "response", &responder_->response().info(), std::string(),
                      PortOptions{.dynamic = true, .doc = "the response to the request", .flat = true});
    announce({responder_->publisher()}, {responder_->subscription()});
    const segue::Lock lock(mutex_);
    counts_ = {};
    return {};
  }

  segue::Result<void> on_start() override {
    {
      const segue::Lock lock(mutex_);
      serves_ = true;
    }
    thread_ = segue::concurrent::start_thread("segue-service", [this] { serve(); });
    return {};
  }

  void on_update() override {
    SampleRef sample = response_->take();
    if (!sample) return;
    // One that has not been looked at yet was for no request.
    answer_.give(std::move(sample));
    waker_.wake();
  }

  void on_stop() override {
    {
      const segue::Lock lock(mutex_);
      serves_ = false;
      waiting_.clear();
    }
    waker_.wake();
    thread_.join();
    answer_.take();
  }

  void on_cleanup() override {
    withdraw();
    responder_.reset();
    request_.reset();
    response_.reset();
    leave();
  }

 private:
  struct Waiting {
    Caller caller;
    std::vector<std::byte> request;
  };

  /// In a thread of Fast DDS.
  void take(const Caller& caller, std::vector<std::byte> request) {
    const segue::Lock lock(mutex_);
    if (!serves_) {
      ++counts_.early;
      return;
    }
    if (waiting_.size() >= *depth_) {
      ++counts_.refused;
      return;
    }
    waiting_.push_back({caller, std::move(request)});
    waker_.wake();
  }

  /// The thread of its own.
  void serve() {
    std::optional<Caller> current;
    segue::TimePoint give_up{};
    while (serves()) {
      waker_.wait(current ? segue::Deadline(give_up) : segue::Deadline(kIdle));
      if (const SampleRef sample = answer_.take(); sample) {
        answer(current, *sample.get());
        current.reset();
      } else if (current && segue::monotonic_now() >= give_up) {
        count(&ServerStatistics::unanswered);
        current.reset();
      }
      if (current || request_->dormant()) continue;
      current = next();
      give_up = segue::monotonic_now() + *timeout_;
    }
  }

  bool serves() {
    const segue::Lock lock(mutex_);
    return serves_;
  }

  /// Writes the next request that is one; whose it is.
  std::optional<Caller> next() {
    while (auto waiting = take_waiting()) {
      const auto outcome = request_->publish(waiting->request);
      if (outcome == CdrOutput::Outcome::Published) {
        count(&ServerStatistics::requests);
        return waiting->caller;
      }
      count(outcome == CdrOutput::Outcome::Corrupt ? &ServerStatistics::corrupt : &ServerStatistics::refused);
    }
    return {};
  }

  std::optional<Waiting> take_waiting() {
    const segue::Lock lock(mutex_);
    if (waiting_.empty()) return {};
    std::optional<Waiting> first = std::move(waiting_.front());
    waiting_.pop_front();
    return first;
  }

  void answer(const std::optional<Caller>& caller, const SampleSlot& sample) {
    if (!caller) return count(&ServerStatistics::unasked);
    const auto message = cdr_of(responder_->response(), sample);
    const bool sent =
        !message.empty() && responder_->respond(*caller, message, segue::monotonic_now() + kIdle);
    count(sent ? &ServerStatistics::responses : &ServerStatistics::unsent);
  }

  void count(std::uint64_t ServerStatistics::*counter) {
    const segue::Lock lock(mutex_);
    ++(counts_.*counter);
  }
  ServerStatistics statistics() {
    const segue::Lock lock(mutex_);
    ServerStatistics now = counts_;
    now.waiting = static_cast<std::uint32_t>(waiting_.size());
    if (responder_ != nullptr) now.clients = responder_->clients();
    return now;
  }

  /// How long a client is waited for that does not get responses yet; how often an idle thread looks around.
  static constexpr std::chrono::seconds kIdle{1};

  Property<std::string> service_{*this, "service", {}, {.doc = "name of the service: /lamp/set"}};
  Property<std::string> type_{*this, "type", {}, {.doc = "its interface: std_srvs/srv/SetBool"}};
  Property<std::chrono::nanoseconds> timeout_{
      *this,
      "timeout",
      std::chrono::seconds(5),
      {.doc =
           "how long a response is waited for; afterwards the client gets none, and the next one is served"}};
  Property<std::uint32_t> depth_{
      *this, "depth", 10, {.doc = "how many requests wait while one is served; others are dropped"}};
  Operation<ServerStatistics()> statistics_{*this,
                                            "statistics",
                                            {},
                                            [this] { return statistics(); },
                                            RunsIn::CallerThread,
                                            "what was served so far"};
  ThreadWaker waker_;
  SampleHandover answer_;
  segue::Mutex mutex_;
  bool serves_ SEGUE_GUARDED_BY(mutex_) = false;
  std::deque<Waiting> waiting_ SEGUE_GUARDED_BY(mutex_);
  ServerStatistics counts_ SEGUE_GUARDED_BY(mutex_);
  // Changed only while there is no thread.
  std::optional<CdrOutput> request_;
  std::optional<AnyInput> response_;
  std::unique_ptr<Responder> responder_;
  std::thread thread_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::ServiceServer)
