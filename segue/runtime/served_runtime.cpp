// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/served_runtime.hpp>

#include <segue/runtime/runtime_implementation.hpp>
#include <segue/runtime/unit_reports.hpp>

#include <utility>

namespace segue::runtime {

Result<std::uint64_t> ServedRuntime::take_lease(std::string holder) {
  return implementation_.take_lease(std::move(holder));
}

std::shared_future<HaltResult> ServedRuntime::end_lease(std::uint64_t lease, bool keep) {
  return implementation_.end_lease(lease, keep);
}

control::LeaseStanding ServedRuntime::lease_standing(std::uint64_t lease) const {
  return implementation_.leases.standing_of(lease);
}

std::optional<Error> ServedRuntime::lease_refusal(std::uint64_t lease) const {
  return implementation_.leases.refusal_of(lease);
}

std::optional<std::string> ServedRuntime::lease_holder() const {
  const auto holder = implementation_.leases.holder();
  return holder ? std::optional(holder->name) : std::nullopt;
}

Result<void> ServedRuntime::allow(const Sender& sender, const std::string& what) {
  if (auto lost = implementation_.refusal_of_lost_robot()) {
    return std::move(*lost);
  }
  return implementation_.leases.allow(sender, what);
}

Result<void> ServedRuntime::report(std::uint64_t lease, type::Value doing) {
  const type::Value* state = doing.find("state");
  const bool is_stopping = state != nullptr && *state == type::Value("stopping");
  const bool tells_of_units_only = doing.find("units") != nullptr && doing.as_map().size() == 1;
  if (auto taken = detail::take_units(doing, lease, implementation_.leases, implementation_.units); !taken) {
    return taken;
  }
  if (tells_of_units_only) {
    return {};
  }
  auto reported = implementation_.leases.report(lease, std::move(doing));
  if (reported && is_stopping) {
    implementation_.stop_holder(implementation_.leases.holder_of(lease));
  }
  return reported;
}

type::Value ServedRuntime::reported() const {
  return implementation_.leases.doing();
}

type::Value ServedRuntime::mission(std::uint64_t after, bool with_plan) {
  return implementation_.leases.mission(after, with_plan, implementation_.halts.on_its_way().valid(),
                                        implementation_.controllers.halt() != nullptr);
}

Result<std::uint64_t> ServedRuntime::send_command(std::string_view what, const type::Value& arguments) {
  auto number = implementation_.leases.ask(what, arguments);
  if (number && what == "stop") {
    implementation_.stop_holder(implementation_.leases.holder());
  }
  return number;
}

std::vector<control::HolderRequest> ServedRuntime::take_commands(std::uint64_t lease) {
  return implementation_.leases.take_commands(lease);
}

std::future<std::vector<Readiness>> ServedRuntime::prepare(std::vector<model::NetworkName> controllers,
                                                           std::uint64_t lease) {
  return implementation_.prepare(std::move(controllers), lease);
}

std::vector<ControllerChange> ServedRuntime::compare(const ControllerSet& set,
                                                     Diagnostics& diagnostics) const {
  diagnostics.append(implementation_.controllers.check(set));
  return implementation_.controllers.compare(set, implementation_.belief.controller().name);
}

Result<std::vector<ControllerConflict>> ServedRuntime::conflicts(
    const std::vector<model::NetworkName>& controllers) const {
  return implementation_.controllers.conflicts(controllers);
}

void ServedRuntime::take_instance(const model::InstanceQuestion& what, const Wait& wait,
                                  model::InstanceAnswer answered) {
  implementation_.pools.take(what, wait, std::move(answered));
}

std::shared_future<HaltResult> ServedRuntime::halt_on_its_way() const {
  return implementation_.halts.on_its_way();
}

std::map<model::DeploymentKey, std::string> ServedRuntime::ended_processes() const {
  return implementation_.faults.ended();
}

std::uint64_t ServedRuntime::changes() const {
  return implementation_.changes.count();
}

void ServedRuntime::watch_changes(std::uint64_t seen, const Wait& wait,
                                  std::function<void(Result<std::uint64_t>)> answered) const {
  implementation_.changes.watch(seen, wait, std::move(answered));
}

Result<void> ServedRuntime::flush_journal(Deadline deadline) const {
  return implementation_.journal.flush(deadline);
}

}  // namespace segue::runtime
