// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/runtime_service.hpp>

#include <segue/base/has_answered.hpp>
#include <segue/base/text.hpp>
#include <segue/control/reader_stream.hpp>
#include <segue/journal/past.hpp>
#include <segue/model/files.hpp>
#include <segue/model/validate.hpp>
#include <segue/runtime/component_libraries.hpp>
#include <segue/runtime/runtime_lease.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/runtime/service_answers.hpp>

#include <unistd.h>

#include <algorithm>

namespace segue::runtime {

namespace {

constexpr auto kJournalPatience = std::chrono::seconds(2);
/// How long whoever wants to command a robot waits until it is at rest.
constexpr auto kRestPatience = std::chrono::seconds(5);

}  // namespace

RuntimeService::RuntimeService(Runtime& runtime, const ControllerFiles* files,
                               std::function<void()> on_shut_down)
    : runtime_(runtime), served_(runtime.served()), files_(files), on_shut_down_(std::move(on_shut_down)) {}

Result<type::Value> RuntimeService::status(const Wait& wait) {
  if (wait.is_stopped()) {
    return no_longer_wanted();
  }
  type::Value status = status_of(runtime_);
  status.as_map().set("file", files_ != nullptr ? type::Value(files_->file().string()) : type::Value());
  status.as_map().set("libraries", component_libraries(runtime_.components()));
  status.as_map().set("pid", static_cast<std::int64_t>(::getpid()));
  status.as_map().set("uptime_s", std::chrono::duration<double>(monotonic_now() - started_).count());
  type::Value::List changed;
  for (const auto& change :
       files_ != nullptr ? files_->changes(runtime_.files()) : std::vector<FileChange>{}) {
    changed.push_back(to_value(change));
  }
  status.as_map().set("changed_files", std::move(changed));
  return status;
}

Result<type::Value> RuntimeService::task(std::string_view id, const Wait& wait) {
  return wait.is_stopped() ? Result<type::Value>(no_longer_wanted())
                           : task_report(runtime_, model::TaskId(id));
}

void RuntimeService::watch(const task_host::LevelQuestion& question, const Wait& wait,
                           control::RobotLevelAnswer answered) {
  runtime_.host().watch(question, wait,
                        [this, answered = std::move(answered)](Result<task_host::TaskLevel> level) {
                          if (!level) return answered(std::move(level.error()));
                          answered(control::RobotLevel{std::move(*level), served_.changes()});
                        });
}

void RuntimeService::changes(std::uint64_t seen, const Wait& wait, control::ChangesAnswer answered) {
  served_.watch_changes(seen, wait, std::move(answered));
}

/// In this order: what runs since the lease was lost is not what its holder has to know.
Result<type::Value> RuntimeService::running(std::uint64_t lease, const Wait& /*wait*/) {
  type::Value running = running_of(runtime_);
  if (lease == 0) {
    return running;
  }
  const auto standing = served_.lease_standing(lease);
  running.as_map().set("lost_to", standing.lost_to ? type::Value(*standing.lost_to) : type::Value());
  running.as_map().set("stopped", standing.is_stopped);
  return running;
}

Result<type::Value> RuntimeService::switch_to(std::string_view controller, const RequestOptions& options,
                                              const Wait& wait) {
  let_rest(wait);
  if (wait.is_stopped()) {
    return no_longer_wanted();
  }
  return answer_to(runtime_.accept(model::NetworkName(controller), options), controller, options, wait);
}

Result<type::Value> RuntimeService::diff(std::string_view controller, const RequestOptions& options,
                                         const Wait& /*wait*/) {
  return answer_of(runtime_.preview(model::NetworkName(controller), options));
}

/// The result of a request, which is cancelled where it is not wanted any more.
Result<type::Value> RuntimeService::answer_to(AcceptedRequest accepted, std::string_view target,
                                              const RequestOptions& options, const Wait& wait) {
  auto answer = answer_of(std::move(accepted.result), target, wait);
  if (!answer && wait.is_stopped()) {
    // A transition that has just ended, or is past its commit, is not cancelled by this.
    static_cast<void>(runtime_.cancel(accepted.number, options.who));
    return no_longer_wanted();
  }
  return answer;
}

Result<type::Value> RuntimeService::repair(const RequestOptions& options, const Wait& wait) {
  let_rest(wait);
  if (wait.is_stopped()) return no_longer_wanted();
  const std::string runs = runtime_.belief().name.str();
  return answer_to(runtime_.repair(options), runs, options, wait);
}

/// The request in a network that was sent.
RuntimeService::Sent RuntimeService::read_sent(std::string_view text, std::string_view file) const {
  Diagnostics diagnostics;
  auto network = model::read_network(text, std::string(file), diagnostics);
  if (!network) {
    return {std::nullopt, refusal(diagnostics, file)};
  }
  auto known = runtime_.controller(network->name);
  if (known && !equivalent(*known, *network)) {
    return {std::nullopt,
            fail(ErrorCode::AlreadyExists,
                 "the robot has another controller " + quote(network->name.str()) +
                     "; give the network a name of its own (`network: NAME`), or edit that controller's file "
                     "and `segue apply` it",
                 network->name.str())};
  }
  return {known ? std::move(known) : std::move(network), type::Value()};
}

Result<type::Value> RuntimeService::switch_to_network(std::string_view text, std::string_view file,
                                                      const RequestOptions& options, TimePoint deadline) {
  auto sent = read_sent(text, file);
  if (!sent.network) {
    return std::move(sent.refusal);
  }
  const std::string name = sent.network->name.str();
  let_rest(deadline);
  return answer_of(runtime_.request(*std::move(sent.network), options), name, deadline);
}

Result<type::Value> RuntimeService::diff_to_network(std::string_view text, std::string_view file,
                                                    const RequestOptions& options, TimePoint /*deadline*/) {
  auto sent = read_sent(text, file);
  if (!sent.network) {
    return std::move(sent.refusal);
  }
  return answer_of(runtime_.preview(*std::move(sent.network), options));
}

Result<type::Value> RuntimeService::plan(std::string_view controller, const RequestOptions& options,
                                         TimePoint /*deadline*/) {
  if (files_ == nullptr) {
    return no_files();
  }
  Diagnostics diagnostics;
  const auto set = files_->read(diagnostics);
  if (!set) {
    return refusal(diagnostics, "the files");
  }
  const auto changes = served_.compare(*set, diagnostics);
  if (diagnostics.has_errors()) {
    return refusal(diagnostics, "the files");
  }
  return plan_for(*set, changes, controller, options, diagnostics);
}

/// The answer of plan() for files without errors.
Result<type::Value> RuntimeService::plan_for(const ControllerSet& set,
                                             const std::vector<ControllerChange>& changes,
                                             std::string_view controller, const RequestOptions& options,
                                             const Diagnostics& diagnostics) const {
  const model::NetworkName runs = runtime_.belief().name;
  const model::NetworkName wanted = controller.empty() ? runs : model::NetworkName(controller);
  type::Value::List list;
  for (const auto& change : changes) {
    list.push_back(to_value(change));
  }
  type::Value answer = type::Value::map({{"outcome", "done"},
                                         {"controller", wanted.str()},
                                         {"from_version", runtime_.version()},
                                         {"to_version", ""},
                                         {"changes", std::move(list)},
                                         {"diagnostics", to_value(diagnostics)}});
  Controllers controllers;
  for (const auto& network : set.controllers) {
    controllers.emplace(network.name, network);
  }
  auto target = find_controller(controllers, wanted, runtime_.components());
  const auto own = target ? std::nullopt : runtime_.controller(wanted);
  if (own && own->version.empty()) {  // added by the program, which no file changes
    target = *own;
  }
  if (!target || wanted.empty()) {
    const bool is_unknown = !target && target.error().code == ErrorCode::NotFound;
    if (controller.empty() && (target || is_unknown)) {
      return answer;
    }
    return is_unknown ? unknown(wanted, set) : std::move(target.error());
  }
  const auto planned = runtime_.preview(*target, options);
  if (!planned) {
    return planned.error();
  }
  answer.as_map().set("to_version", target->version);
  answer.as_map().set("transition", to_value(*planned));
  return answer;
}

Result<type::Value> RuntimeService::apply(const RequestOptions& options, TimePoint deadline) {
  if (files_ == nullptr) {
    return no_files();
  }
  Diagnostics diagnostics;
  std::future<ApplyResult> future;
  let_rest(deadline);
  {
    const Lock lock(applying_);
    auto set = files_->read(diagnostics);
    if (!set) {
      return refusal(diagnostics, "the files");
    }
    future = runtime_.apply(std::move(*set), options);
  }
  if (future.wait_until(deadline) != std::future_status::ready) {
    return fail(
        ErrorCode::DeadlineExceeded,
        "the files are applied, but the running controller has not gone to its new version yet; watch it "
        "with 'segue events'");
  }
  const ApplyResult result = future.get();
  type::Value answer = to_value(result);
  if (result.error && result.error->diagnostics) {
    diagnostics.append(*result.error->diagnostics);
  }
  if (!diagnostics.empty()) {
    answer.as_map().set("diagnostics", to_value(diagnostics));
  }
  return answer;
}

Result<type::Value> RuntimeService::prepare(const std::vector<std::string>& controllers, std::uint64_t lease,
                                            const Wait& wait) {
  if (wait.is_stopped()) {
    return no_longer_wanted();
  }
  if (auto refusal = served_.lease_refusal(lease)) {
    return std::move(*refusal);
  }
  auto future = served_.prepare({controllers.begin(), controllers.end()}, lease);
  if (!has_answered(future, wait)) {
    return fail(ErrorCode::DeadlineExceeded,
                "the controllers are not all prepared yet; watch it with 'segue events'");
  }
  type::Value::List list;
  for (const auto& one : future.get()) {
    list.push_back(to_value(one));
  }
  return type::Value(std::move(list));
}

Result<type::Value> RuntimeService::conflicts(const std::vector<std::string>& controllers, const Wait& wait) {
  if (wait.is_stopped()) {
    return no_longer_wanted();
  }
  std::vector<model::NetworkName> names(controllers.begin(), controllers.end());
  const auto found = served_.conflicts(controllers.empty() ? runtime_.controllers() : names);
  if (!found) {
    return found.error();
  }
  type::Value::List list;
  for (const auto& one : *found) {
    list.push_back(type::Value::map({{"a", one.a.str()},
                                     {"b", one.b.str()},
                                     {"what", one.conflict.what},
                                     {"reason", one.conflict.reason},
                                     {"influence", one.influence}}));
  }
  return type::Value(std::move(list));
}

Result<std::unique_ptr<control::RobotLease>> RuntimeService::lease(std::string_view holder) {
  let_rest(kRestPatience);
  const auto number = served_.take_lease(std::string(holder));
  if (!number) {
    return number.error();
  }
  return std::unique_ptr<control::RobotLease>(std::make_unique<RuntimeLease>(served_, *number));
}

Result<void> RuntimeService::report(std::uint64_t lease, const type::Value& doing) {
  return served_.report(lease, doing);
}

Result<type::Value> RuntimeService::mission(std::uint64_t after, bool with_plan) {
  return served_.mission(after, with_plan);
}

Result<std::uint64_t> RuntimeService::send_command(std::string_view what, const type::Value& arguments) {
  return served_.send_command(what, arguments);
}

Result<type::Value> RuntimeService::give_back(std::uint64_t lease, bool keep, TimePoint deadline) {
  return answer_of(served_.end_lease(lease, keep), deadline);
}

Result<type::Value> RuntimeService::stop(std::string_view who, TimePoint deadline) {
  return answer_of(runtime_.halt({.who = std::string(who), .latch = true}), deadline);
}

Result<void> RuntimeService::release_stop(std::string_view who) {
  return runtime_.release(std::string(who));
}

Result<type::Value> RuntimeService::cancel(std::uint64_t request, std::string_view who, TimePoint deadline) {
  auto future = runtime_.cancel(request, std::string(who));
  if (!future) {
    return std::move(future.error());
  }
  if (future->wait_until(deadline) != std::future_status::ready) {
    return fail(ErrorCode::DeadlineExceeded,
                "it is cancelled, but not undone yet; watch it with 'segue events'");
  }
  return to_value(future->get());
}

Result<type::Value> RuntimeService::apply_transition(const control::GivenTransition& given,
                                                     const RequestOptions& options, TimePoint deadline) {
  auto transition = given.name.empty() ? read_given(given) : runtime_.transition(given.name);
  if (!transition) {
    return std::move(transition.error());
  }
  const std::string target = transition->to.str();
  let_rest(deadline);
  return answer_of(runtime_.request(*std::move(transition), options), target, deadline);
}

Result<void> RuntimeService::reset_belief(std::string_view network, std::string_view file) {
  if (network.empty()) {
    runtime_.reset_belief();
    return {};
  }
  Diagnostics diagnostics;
  auto believed = model::read_network(network, std::string(file), diagnostics);
  if (believed) {
    diagnostics.append(model::validate(*believed, {}, model::Depth::Structure));
  }
  if (diagnostics.has_errors()) {
    return diagnostics.to_error(ErrorCode::ParseError);
  }
  runtime_.reset_belief(std::move(*believed));
  return {};
}

Result<void> RuntimeService::set_property(std::string_view task, std::string_view property,
                                          const type::Value& value, const control::Sender& sender,
                                          const Wait& wait) {
  if (auto allowed = allow(sender, "sets", task, property, wait); !allowed) {
    return allowed;
  }
  return runtime_.set_property(model::TaskId(task), property, value, sender.who, wait.deadline);
}

Result<type::Value> RuntimeService::call(std::string_view task, std::string_view operation,
                                         const type::Value& arguments, const control::Sender& sender,
                                         const Wait& wait) {
  if (auto allowed = allow(sender, "calls", task, operation, wait); !allowed) {
    return std::move(allowed.error());
  }
  return runtime_.call(model::TaskId(task), operation, arguments, wait);
}

void RuntimeService::take_instance(const model::InstanceQuestion& what, const Wait& wait,
                                   model::InstanceAnswer answered) {
  served_.take_instance(what, wait, std::move(answered));
}

Result<void> RuntimeService::write(std::string_view task, std::string_view port, const type::Value& value,
                                   const control::Sender& sender, const Wait& wait) {
  if (auto allowed = allow(sender, "writes to", task, port, wait); !allowed) {
    return allowed;
  }
  return runtime_.host().write({model::TaskId(task), std::string(port)}, value, wait.deadline);
}

void RuntimeService::let_rest(const Wait& wait) const {
  if (const auto halt = served_.halt_on_its_way(); halt.valid()) {
    has_answered(halt, wait);
  }
}

Result<void> RuntimeService::allow(const control::Sender& sender, std::string_view verb,
                                   std::string_view task, std::string_view member, const Wait& wait) const {
  if (wait.is_stopped()) {
    return no_longer_wanted();
  }
  return served_.allow(sender, std::string(verb) + " " + std::string(task) + "." + std::string(member));
}

Result<std::unique_ptr<control::SampleStream>> RuntimeService::open_port(std::string_view task,
                                                                         std::string_view port,
                                                                         std::size_t buffer,
                                                                         const Wait& wait) {
  if (wait.is_stopped()) {
    return no_longer_wanted();
  }
  auto reader = runtime_.host().open_reader({model::TaskId(task), std::string(port)}, buffer);
  if (!reader) {
    return std::move(reader.error());
  }
  return std::unique_ptr<control::SampleStream>(std::make_unique<control::ReaderStream>(std::move(*reader)));
}

Result<type::Value> RuntimeService::events(std::uint64_t after, const Wait& wait) {
  type::Value::List list;
  for (const auto& event : runtime_.events(after, wait))
    list.push_back(to_value(event));
  if (list.empty() && wait.is_stopped()) return no_longer_wanted();
  return type::Value(std::move(list));
}

Result<type::Value> RuntimeService::history() {
  type::Value::List list;
  for (const auto& result : runtime_.history()) {
    list.push_back(to_value(result));
  }
  return type::Value(std::move(list));
}

Result<type::Value> RuntimeService::past(const type::Value& question) {
  const auto& path = runtime_.journal();
  if (path.empty()) {
    return fail(ErrorCode::Unsupported, "the robot keeps no journal, so nothing is known of its past");
  }
  // Where the file cannot be written now, the answer is what it has.
  static_cast<void>(served_.flush_journal(kJournalPatience));
  return journal::answer_about_past(path, question);
}

Result<void> RuntimeService::shut_down() {
  on_shut_down_();
  return {};
}

}  // namespace segue::runtime
