// SPDX-License-Identifier: Apache-2.0
#include "service_executor.hpp"

#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

namespace ros2 {

using segue::type::Value;

namespace {

/// A task that does not answer holds one of them.
constexpr std::size_t kExecutorThreads = 4;
constexpr std::size_t kMostQueued = 1000;
constexpr std::size_t kMostOfGroup = 100;
constexpr std::size_t kMostResponses = 200;
/// An answer may be a hundred times as large.
constexpr std::size_t kLargestRequest = std::size_t{64} << 10U;
/// As long as clients of ROS 2 wait, or less: what is done after that surprises whoever has given up.
constexpr std::chrono::seconds kRequestWaits{5};
constexpr std::chrono::seconds kResponseWaits{2};
/// How often it is looked whether clients get responses by now.
constexpr std::chrono::milliseconds kLookAgain{5};

}  // namespace

/// Where the requests of one service come in.
class ServiceExecutor::Handle {
 public:
  explicit Handle(Answer answer) : answer_(std::move(answer)) {}

 private:
  friend class ServiceExecutor;
  const Answer answer_;
  std::unique_ptr<Responder> responder_;  ///< set while its group is being opened
};

ServiceExecutor::ServiceExecutor(std::shared_ptr<Participant> participant)
    : participant_(std::move(participant)) {
  for (std::size_t i = 0; i < kExecutorThreads; ++i)
    threads_.push_back(segue::concurrent::start_thread("segue-services", [this] { work(); }));
}

ServiceExecutor::~ServiceExecutor() {
  {
    const segue::Lock lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_)
    thread.join();
}

segue::Result<std::shared_ptr<ServiceExecutor::Handle>> ServiceExecutor::open(
    segue::ros2::InterfaceLibrary& library, const Service& service, Answer answer) {
  auto handle = std::make_shared<Handle>(std::move(answer));
  auto take_request = [this, weak = std::weak_ptr(handle), group = service.group](
                          const Caller& caller, std::vector<std::byte> request) {
    take({weak, caller, std::move(request), segue::monotonic_now() + kRequestWaits}, group);
  };
  // The first request may come before the responder is here.
  {
    const segue::Lock lock(mutex_);
    opening_.insert(service.group);
  }
  auto made =
      Responder::make(participant_, library, service.name, service.interface, std::move(take_request));
  if (made) handle->responder_ = std::move(*made);
  {
    const segue::Lock lock(mutex_);
    opening_.erase(service.group);
  }
  changed_.notify_all();
  if (!made) return made.error();
  return handle;
}

void ServiceExecutor::take(Message request, const std::string& group) {
  {
    const segue::Lock lock(mutex_);
    const auto of_group = std::ranges::count(waiting_, group, &Waiting::group);
    if (ends_ || waiting_.size() >= kMostQueued || static_cast<std::size_t>(of_group) >= kMostOfGroup ||
        request.message.size() > kLargestRequest) {
      ++counts_.dropped;
      return;
    }
    waiting_.push_back({group, std::move(request)});
  }
  changed_.notify_one();
}

void ServiceExecutor::work() {
  std::string group;
  while (true) {
    const auto request = next_request(group);
    if (request) carry_out(*request);
    send_responses();
    const segue::Lock lock(mutex_);
    if (request) {
      busy_.erase(group);
      changed_.notify_one();  // for one that has waited for this group
    }
    if (ends_) return;
  }
}

/// Nothing: there is none, but responses may have to be sent, or it ends.
std::optional<ServiceExecutor::Message> ServiceExecutor::next_request(std::string& group) {
  segue::Lock lock(mutex_);
  while (!ends_) {
    const auto next = std::ranges::find_if(waiting_, [&](const Waiting& one) SEGUE_REQUIRES(mutex_) {
      return !busy_.contains(one.group) && !opening_.contains(one.group);
    });
    if (next != waiting_.end()) {
      Message request = std::move(next->request);
      group = std::move(next->group);
      waiting_.erase(next);
      if (request.until < segue::monotonic_now()) {
        ++counts_.dropped;
        continue;
      }
      busy_.insert(group);
      return request;
    }
    if (responses_.empty()) {
      changed_.wait(mutex_);
    } else {
      changed_.wait_until(mutex_, segue::monotonic_now() + kLookAgain);
      return {};
    }
  }
  return {};
}

void ServiceExecutor::carry_out(const Message& request) {
  const auto handle = request.handle.lock();
  if (handle == nullptr) return count(&ExposureStatistics::dropped);
  const auto asked = handle->responder_->request().decode(request.message);
  if (!asked) return count(&ExposureStatistics::corrupt);
  const auto answer = handle->answer_(*asked);
  count(&ExposureStatistics::requests);
  if (!answer) return;
  auto message = handle->responder_->response().encode(*answer, "response");
  if (!message) return count(&ExposureStatistics::unsent);
  const segue::Lock lock(mutex_);
  if (responses_.size() >= kMostResponses) {
    // Only those of clients that do not get any yet are left here.
    responses_.erase(responses_.begin());
    ++counts_.unsent;
  }
  responses_.push_back(
      {request.handle, request.caller, std::move(*message), segue::monotonic_now() + kResponseWaits});
}

void ServiceExecutor::send_responses() {
  std::vector<Message> all;
  {
    const segue::Lock lock(mutex_);
    all.swap(responses_);
  }
  std::vector<Message> early;
  for (Message& one : all) {
    const auto handle = one.handle.lock();
    const bool is_late = handle == nullptr || one.until < segue::monotonic_now();
    if (is_late) {
      count(&ExposureStatistics::unsent);
    } else if (!handle->responder_->reaches(one.caller)) {
      early.push_back(std::move(one));
    } else {
      const bool sent = handle->responder_->respond(one.caller, one.message, segue::monotonic_now());
      count(sent ? &ExposureStatistics::responses : &ExposureStatistics::unsent);
    }
  }
  const segue::Lock lock(mutex_);
  std::ranges::move(early, std::back_inserter(responses_));
}

void ServiceExecutor::count(std::uint64_t ExposureStatistics::*counter) {
  const segue::Lock lock(mutex_);
  ++(counts_.*counter);
}

ExposureStatistics ServiceExecutor::statistics() const {
  const segue::Lock lock(mutex_);
  return counts_;
}

segue::ros2::Gid ServiceExecutor::publisher(const Handle& handle) {
  return handle.responder_->publisher();
}

segue::ros2::Gid ServiceExecutor::subscription(const Handle& handle) {
  return handle.responder_->subscription();
}

}  // namespace ros2
