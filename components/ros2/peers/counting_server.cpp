// SPDX-License-Identifier: Apache-2.0
//
// A node of ROS 2 with the action /count, for the manual's page: counts to `target`, ten times a second, one
// goal at a time and not further than to 1000.
//   counting_server fastdds|cyclone FOLDER FILE
// FOLDER has count_msgs/action/Count.action, FILE gets what it does; domain $ROS_DOMAIN_ID.
#include "count_messages.hpp"
#include "peer.hpp"

#include <segue/type/value.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>

namespace ros2::testing {
namespace {

using segue::type::Value;

constexpr std::int64_t kFurthest = 1000;
constexpr const char* kInterface = "count_msgs/action/Count";
constexpr int kExecuting = 2;
constexpr int kSucceeded = 4;
constexpr int kCanceled = 5;

class CountingServer {
 public:
  CountingServer(std::unique_ptr<Peer> (*make)(std::uint32_t), std::uint32_t domain,
                 const std::string& folder)
      : codecs_(folder, kInterface), goals_(make(domain)), cancels_(make(domain)), results_(make(domain)) {
    serve_count(*goals_, *cancels_, *results_, kInterface);
  }

  [[noreturn]] void run() {
    for (auto next = std::chrono::steady_clock::now();;
         std::this_thread::sleep_for(std::chrono::milliseconds(2))) {
      answer();
      if (std::chrono::steady_clock::now() < next) continue;
      next += std::chrono::milliseconds(100);
      if (goal_) count();
    }
  }

 private:
  void answer() {
    for (const Request& request : goals_->requests()) {
      const Value asked = codecs_.goal_request.decode(request.message).value();
      const std::int64_t target = asked.find("goal")->find("target")->as_int();
      const bool accepts = target <= kFurthest && !goal_;
      std::printf("count to %lld: %s\n", static_cast<long long>(target), accepts ? "accepted" : "refused");
      if (accepts) goal_ = Goal{*asked.find("goal_id"), target, 0, {}};
      goals_->respond(request, codecs_.goal_response.encode(Value::map({{"accepted", accepts}}), "").value());
      if (accepts) tell_status(kExecuting);
    }
    for (const Request& request : results_->requests()) {
      if (goal_) goal_->asked = request;
      answer_result();
    }
    for (const Request& request : cancels_->requests()) {
      cancels_->respond(
          request, codecs_.cancel_response.encode(Value::map({{"return_code", goal_ ? 0 : 3}}), "").value());
      if (goal_) end(kCanceled);
    }
  }

  void count() {
    if (goal_->status != 0) return;
    if (++goal_->now >= goal_->target) return end(kSucceeded);
    const Value message =
        Value::map({{"goal_id", goal_->id}, {"feedback", Value::map({{"now", goal_->now}})}});
    goals_->publish(codecs_.feedback.encode(message, "").value());
  }

  void end(int status) {
    if (goal_->status != 0) return;
    std::printf("%s at %lld\n", status == kCanceled ? "canceled" : "done",
                static_cast<long long>(goal_->now));
    goal_->status = status;
    tell_status(status);
    answer_result();
  }

  /// The client asks for the result before or after the end.
  void answer_result() {
    if (!goal_ || goal_->status == 0 || !goal_->asked) return;
    const Value result =
        Value::map({{"status", goal_->status}, {"result", Value::map({{"reached", goal_->now}})}});
    results_->respond(*goal_->asked, codecs_.result_response.encode(result, "").value());
    goal_.reset();
  }

  void tell_status(int status) {
    const Value one = Value::map({{"goal_info", Value::map({{"goal_id", goal_->id}})}, {"status", status}});
    cancels_->publish(codecs_.status.encode(Value::map({{"status_list", Value::list({one})}}), "").value());
  }

  struct Goal {
    Value id;
    std::int64_t target = 0;
    std::int64_t now = 0;
    std::optional<Request> asked{};  ///< for its result
    int status = 0;                  ///< how it has ended
  };
  const ActionCodecs codecs_;
  std::unique_ptr<Peer> goals_;    ///< and feedback
  std::unique_ptr<Peer> cancels_;  ///< and status
  std::unique_ptr<Peer> results_;
  std::optional<Goal> goal_;
};

}  // namespace
}  // namespace ros2::testing

int main(int argc, char** argv) {
  if (argc != 4 || std::freopen(argv[3], "w", stdout) == nullptr) return 2;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const char* domain = std::getenv("ROS_DOMAIN_ID");
  const auto number = static_cast<std::uint32_t>(domain == nullptr ? 0 : std::atoi(domain));
  const bool is_fast = std::string(argv[1]) == "fastdds";
  ros2::testing::CountingServer(is_fast ? ros2::testing::make_fast_peer : ros2::testing::make_cyclone_peer,
                                number, argv[2])
      .run();
}
