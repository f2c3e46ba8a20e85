// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/runtime/controller_files.hpp>
#include <segue/runtime/runtime.hpp>

#include <functional>

namespace segue::runtime {

/// Offers a Runtime to other processes. Functions may be called from any thread.
class RuntimeService final : public control::RobotService {
 public:
  /// `runtime` and `files` must outlive this. Without files (nullptr) there is nothing to plan or apply.
  /// `on_shut_down` is called in the caller's thread when a client requests shut-down; it must not block.
  RuntimeService(Runtime& runtime, const ControllerFiles* files, std::function<void()> on_shut_down);

  using control::RobotService::conflicts;
  using control::RobotService::open_port;
  using control::RobotService::status;
  using control::RobotService::task;
  Result<type::Value> status(const Wait& wait) override;
  Result<type::Value> task(std::string_view id, const Wait& wait) override;
  void watch(const task_host::LevelQuestion& question, const Wait& wait,
             control::RobotLevelAnswer answered) override;
  Result<type::Value> running(std::uint64_t lease, const Wait& wait) override;
  void changes(std::uint64_t seen, const Wait& wait, control::ChangesAnswer answered) override;
  Result<type::Value> switch_to(std::string_view controller, const RequestOptions& options,
                                const Wait& wait) override;
  Result<type::Value> switch_to_network(std::string_view text, std::string_view file,
                                        const RequestOptions& options, TimePoint deadline) override;
  Result<type::Value> diff(std::string_view controller, const RequestOptions& options,
                           const Wait& wait) override;
  Result<type::Value> diff_to_network(std::string_view text, std::string_view file,
                                      const RequestOptions& options, TimePoint deadline) override;
  Result<type::Value> plan(std::string_view controller, const RequestOptions& options,
                           TimePoint deadline) override;
  Result<type::Value> apply(const RequestOptions& options, TimePoint deadline) override;
  Result<type::Value> repair(const RequestOptions& options, const Wait& wait) override;
  Result<type::Value> prepare(const std::vector<std::string>& controllers, std::uint64_t lease,
                              const Wait& wait) override;
  Result<type::Value> conflicts(const std::vector<std::string>& controllers, const Wait& wait) override;
  Result<std::unique_ptr<control::RobotLease>> lease(std::string_view holder) override;
  Result<void> report(std::uint64_t lease, const type::Value& doing) override;
  Result<type::Value> mission(std::uint64_t after, bool with_plan) override;
  Result<std::uint64_t> send_command(std::string_view what, const type::Value& arguments) override;
  Result<type::Value> give_back(std::uint64_t lease, bool keep, TimePoint deadline) override;
  Result<type::Value> stop(std::string_view who, TimePoint deadline) override;
  Result<void> release_stop(std::string_view who) override;
  Result<type::Value> cancel(std::uint64_t request, std::string_view who, TimePoint deadline) override;
  Result<type::Value> apply_transition(const control::GivenTransition& transition,
                                       const RequestOptions& options, TimePoint deadline) override;
  Result<void> reset_belief(std::string_view network, std::string_view file) override;
  Result<type::Value> units() override;
  Result<std::uint32_t> set_units(std::string_view name, std::uint32_t count, std::string_view who) override;
  Result<void> set_property(std::string_view task, std::string_view property, const type::Value& value,
                            const control::Sender& sender, const Wait& wait) override;
  Result<type::Value> call(std::string_view task, std::string_view operation, const type::Value& arguments,
                           const control::Sender& sender, const Wait& wait) override;
  void take_instance(const model::InstanceQuestion& what, const Wait& wait,
                     model::InstanceAnswer answered) override;
  Result<void> write(std::string_view task, std::string_view port, const type::Value& value,
                     const control::Sender& sender, const Wait& wait) override;
  Result<std::unique_ptr<control::SampleStream>> open_port(std::string_view task, std::string_view port,
                                                           std::size_t buffer, const Wait& wait) override;
  Result<type::Value> events(std::uint64_t after, const Wait& wait) override;
  Result<type::Value> history() override;
  Result<type::Value> past(const type::Value& question) override;
  Result<void> shut_down() override;

 private:
  /// Whoever wants the robot while it comes to rest waits until it has, rather than be refused for a moment.
  void let_rest(const Wait& wait) const;
  /// Whether that sender may do this with a member of a task ("sets", "wheels", "speed"), and still wants it.
  Result<void> allow(const control::Sender& sender, std::string_view verb, std::string_view task,
                     std::string_view member, const Wait& wait) const;
  /// A network that was sent by value, or the answer where it cannot be requested.
  struct Sent {
    std::optional<model::Network> network;
    Result<type::Value> refusal;
  };
  [[nodiscard]] Sent read_sent(std::string_view text, std::string_view file) const;
  Result<type::Value> answer_to(AcceptedRequest accepted, std::string_view target,
                                const RequestOptions& options, const Wait& wait);
  [[nodiscard]] Result<type::Value> plan_for(const ControllerSet& set,
                                             const std::vector<ControllerChange>& changes,
                                             std::string_view controller, const RequestOptions& options,
                                             const Diagnostics& diagnostics) const;

  Runtime& runtime_;
  ServedRuntime& served_;
  const ControllerFiles* files_;
  Mutex applying_;  ///< files are applied in the order in which they are read
  std::function<void()> on_shut_down_;
  TimePoint started_ = RealClock::instance().now();
};

}  // namespace segue::runtime
