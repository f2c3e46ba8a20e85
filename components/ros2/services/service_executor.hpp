// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/types.hpp"
#include "responder.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace ros2 {

/// Serves many services with few threads. Any number of clients may send whatever they like: requests that
/// nobody gets round to are dropped, and a client that does not take its response holds up nobody.
class ServiceExecutor {
 public:
  /// Returns the response to a request; nothing: there is none. In a thread of the executor.
  using Answer = std::function<std::optional<segue::type::Value>(const segue::type::Value& request)>;
  struct Service {
    std::string name;       ///< "/talker/get_state"
    std::string interface;  ///< "lifecycle_msgs/srv/GetState"
    std::string group;      ///< requests of one group are carried out one after the other
  };
  class Handle;

  explicit ServiceExecutor(std::shared_ptr<Participant> participant);
  /// Requests that wait are dropped; those in progress are waited for.
  ~ServiceExecutor();
  ServiceExecutor(const ServiceExecutor&) = delete;
  ServiceExecutor& operator=(const ServiceExecutor&) = delete;

  /// A service that is offered as long as what is returned lives. One thread at a time. Fails as
  /// Responder::make().
  segue::Result<std::shared_ptr<Handle>> open(segue::ros2::InterfaceLibrary& library, const Service& service,
                                              Answer answer);
  /// The endpoints of a service.
  static segue::ros2::Gid publisher(const Handle& handle);
  static segue::ros2::Gid subscription(const Handle& handle);
  /// Without `nodes`.
  [[nodiscard]] ExposureStatistics statistics() const;

 private:
  /// A request, or the response to one.
  struct Message {
    std::weak_ptr<Handle> handle;
    Caller caller;
    std::vector<std::byte> message;
    segue::TimePoint until;  ///< nobody waits for it any more
  };

  /// In a thread of Fast DDS.
  void take(Message request, const std::string& group);
  void work();
  std::optional<Message> next_request(std::string& group);
  void carry_out(const Message& request);
  /// Sends the responses whose clients get them now.
  void send_responses();
  void count(std::uint64_t ExposureStatistics::*counter);

  struct Waiting {
    std::string group;
    Message request;
  };
  const std::shared_ptr<Participant> participant_;
  mutable segue::Mutex mutex_;
  segue::ConditionVariable changed_;
  bool ends_ SEGUE_GUARDED_BY(mutex_) = false;
  std::deque<Waiting> waiting_ SEGUE_GUARDED_BY(mutex_);
  std::set<std::string> busy_ SEGUE_GUARDED_BY(mutex_);     ///< groups
  std::set<std::string> opening_ SEGUE_GUARDED_BY(mutex_);  ///< groups, whose requests wait for that
  std::vector<Message> responses_ SEGUE_GUARDED_BY(mutex_);
  ExposureStatistics counts_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::thread> threads_;
};

}  // namespace ros2
