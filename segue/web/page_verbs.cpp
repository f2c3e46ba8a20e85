// SPDX-License-Identifier: Apache-2.0
#include <segue/web/page_verbs.hpp>

#include <segue/base/clock.hpp>
#include <segue/base/text.hpp>
#include <segue/control/verbs.hpp>

#include <array>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace segue::web {

namespace {

using control::RequestOptions;
using control::RobotService;
using control::Verb;
using type::Value;

constexpr Duration kSwitchTime = std::chrono::seconds(60);
constexpr Duration kCallTime = std::chrono::seconds(10);

struct Request {
  RobotService& robot;
  const Command& command;
  const std::string& who;
};

Result<RequestOptions> options_of(const Request& request) {
  const auto force = request.command.flag("force");
  if (!force) return force.error();
  const auto take_over = request.command.flag("take_over");
  if (!take_over) return take_over.error();
  const auto named = request.command.text_or("order", "");
  if (!named) return named.error();
  const auto order = model::order_named(*named);
  if (!order) return order.error();
  return RequestOptions{.order = *order, .force = *force, .who = request.who, .take_over = *take_over};
}

Result<Value> ask_switch(const Request& request, bool dry_run) {
  const auto controller = request.command.text("controller");
  if (!controller) return controller.error();
  const auto options = options_of(request);
  if (!options) return options.error();
  const auto deadline = request.command.deadline(kSwitchTime);
  if (!deadline) return deadline.error();
  return dry_run ? request.robot.diff(*controller, *options, *deadline)
                 : request.robot.switch_to(*controller, *options, *deadline);
}

/// Takes the robot's files as they are now; with `dry_run`, answers with the changes that this would make.
Result<Value> take_files(const Request& request, bool dry_run) {
  const auto options = options_of(request);
  if (!options) return options.error();
  const auto deadline = request.command.deadline(kSwitchTime);
  if (!deadline) return deadline.error();
  return dry_run ? request.robot.plan("", *options, *deadline) : request.robot.apply(*options, *deadline);
}

Result<Value> ask_plan(const Request& request) {
  return take_files(request, true);
}

Result<Value> do_apply(const Request& request) {
  return take_files(request, false);
}

Result<Value> ask_diff(const Request& request) {
  return ask_switch(request, true);
}

Result<Value> do_switch(const Request& request) {
  return ask_switch(request, false);
}

Result<Value> do_repair(const Request& request) {
  const auto options = options_of(request);
  if (!options) return options.error();
  const auto deadline = request.command.deadline(kSwitchTime);
  if (!deadline) return deadline.error();
  return request.robot.repair(*options, *deadline);
}

/// A request in progress, 0: the newest.
Result<Value> do_cancel(const Request& request) {
  const auto number = request.command.number_or("request", 0);
  if (!number) return number.error();
  const auto deadline = request.command.deadline(kSwitchTime);
  if (!deadline) return deadline.error();
  return request.robot.cancel(*number, request.who, *deadline);
}

/// Whoever commands it.
Result<Value> do_stop(const Request& request) {
  const auto deadline = request.command.deadline(kSwitchTime);
  if (!deadline) return deadline.error();
  return request.robot.stop(request.who, *deadline);
}

Result<Value> do_release(const Request& request) {
  const auto released = request.robot.release_stop(request.who);
  return released ? Result<Value>(Value()) : Result<Value>(released.error());
}

Result<Value> do_prepare(const Request& request) {
  const auto controllers = request.command.texts("controllers");
  if (!controllers) return controllers.error();
  const auto deadline = request.command.deadline(kSwitchTime);
  if (!deadline) return deadline.error();
  return request.robot.prepare(*controllers, 0, *deadline);
}

/// The two names and the value that set, call and write have in common.
template <class Use>
Result<Value> with_member(const Request& request, std::string_view member, Use use) {
  const auto beside = request.command.flag("beside_mission");
  if (!beside) return beside.error();
  const control::Sender sender{.who = request.who, .beside_mission = *beside};
  const auto task = request.command.text("task");
  if (!task) return task.error();
  const auto name = request.command.text(member);
  if (!name) return name.error();
  const auto value = request.command.value();
  if (!value) return value.error();
  const auto deadline = request.command.deadline(kCallTime);
  if (!deadline) return deadline.error();
  return use(*task, *name, *value, sender, *deadline);
}

Result<Value> nothing_or_error(const Result<void>& done) {
  return done ? Result<Value>(Value()) : Result<Value>(done.error());
}

Result<Value> do_set(const Request& request) {
  return with_member(
      request, "property",
      [&](const auto& task, const auto& name, const Value& value, const auto& sender, TimePoint until) {
        return nothing_or_error(request.robot.set_property(task, name, value, sender, until));
      });
}

Result<Value> do_call(const Request& request) {
  return with_member(request, "operation",
                     [&](const auto& task, const auto& name, const Value& value, const auto& sender,
                         TimePoint until) { return request.robot.call(task, name, value, sender, until); });
}

Result<Value> do_write(const Request& request) {
  return with_member(
      request, "port",
      [&](const auto& task, const auto& name, const Value& value, const auto& sender, TimePoint until) {
        return nothing_or_error(request.robot.write(task, name, value, sender, until));
      });
}

/// Sends a request to the mission (control::RobotService::send_command) with its arguments beside "what";
/// answers with its number, since the mission may take its time.
Result<Value> ask_of_mission(const Request& request) {
  const auto what = request.command.text("what");
  if (!what) return what.error();
  auto mission = request.robot.mission(std::numeric_limits<std::uint64_t>::max(), false);
  if (!mission) return mission;
  const Value* state = mission->find("state");
  if (state == nullptr || *state == Value("ended"))
    return fail(ErrorCode::NotFound, "no mission commands the robot");
  Value arguments = request.command.arguments();
  arguments.as_map().erase("what");
  const auto number = request.robot.send_command(*what, arguments);
  return number ? Result<Value>(Value::map({{"number", *number}})) : Result<Value>(number.error());
}

Result<Value> ask_status(const Request& request) {
  return request.robot.status();
}

Result<Value> ask_task(const Request& request) {
  const auto task = request.command.text("task");
  if (!task) return task.error();
  return request.robot.task(*task);
}

Result<Value> ask_events(const Request& request) {
  const auto after = request.command.number_or("after", 0);
  if (!after) return after.error();
  return request.robot.events(*after, Duration(0));
}

/// Asks the journal of the robot, which says itself what a question needs.
/// An answer with the robot's clock gets the one of documents of ports, too, so that a page can compare times
/// of both.
Result<Value> ask_past(const Request& request) {
  using Seconds = std::chrono::duration<double>;
  const TimePoint asked = monotonic_now();
  auto answer = request.robot.past(request.command.arguments());
  const Duration half = (monotonic_now() - asked) / 2;
  if (!answer || answer->find("now_s") == nullptr) return answer;
  answer->as_map().set("studio_s", Seconds((asked + half).time_since_epoch()).count());
  answer->as_map().set("within_s", Seconds(half).count());
  return answer;
}

using OfRobot = Result<Value> (*)(const Request&);
using OfFiles = Result<Value> (FileVerbs::*)(const Command&);
using OfMissions = Result<Value> (MissionStarts::*)(const Command&, const PageUser& user);
using OfRos2 = void (Ros2Looks::*)(const Command&, Ros2Looks::Answer);

struct VerbEntry {
  VerbForm form;
  std::variant<OfRobot, OfFiles, OfMissions, OfRos2> execute;
};

const std::vector<VerbEntry>& verb_entries() {
  static const std::vector<VerbEntry> entries = {
      {{"status", Verb::Status, {}}, ask_status},
      {{"task", Verb::Task, {"task"}}, ask_task},
      {{"events", Verb::Events, {"after"}}, ask_events},
      {{"past", Verb::Past, {"ask", "id", "before", "limit", "words", "time_s"}}, ask_past},
      {{"diff", Verb::Plan, {"controller", "force", "order", "timeout_s"}}, ask_diff},
      {{"switch", Verb::Switch, {"controller", "force", "order", "take_over", "timeout_s"}}, do_switch},
      {{"repair", Verb::Repair, {"force", "order", "take_over", "timeout_s"}}, do_repair},
      {{"cancel", Verb::Cancel, {"request", "timeout_s"}}, do_cancel},
      {{"stop", Verb::Stop, {"timeout_s"}}, do_stop},
      {{"release", Verb::ReleaseStop, {}}, do_release},
      {{"mission", Verb::SendCommand, {"what", "how", "at", "of"}}, ask_of_mission},
      {{"mission_form", Verb::LookAtFiles, {"path"}}, &MissionStarts::form},
      {{"start_mission", Verb::Lease, {"path", "inputs", "mode", "simulate", "steps_back", "timeout_s"}},
       &MissionStarts::start},
      {{"prepare", Verb::Prepare, {"controllers", "timeout_s"}}, do_prepare},
      {{"set", Verb::Set, {"task", "property", "value", "yaml", "beside_mission", "timeout_s"}}, do_set},
      {{"call", Verb::Call, {"task", "operation", "value", "yaml", "beside_mission", "timeout_s"}}, do_call},
      {{"write", Verb::Write, {"task", "port", "value", "yaml", "beside_mission", "timeout_s"}}, do_write},
      {{"files", Verb::LookAtFiles, {}}, &FileVerbs::list},
      {{"read_file", Verb::LookAtFiles, {"path"}}, &FileVerbs::read},
      {{"check_file", Verb::LookAtFiles, {"path", "text"}}, &FileVerbs::check},
      {{"save_file", Verb::ChangeFiles, {"path", "text", "version"}}, &FileVerbs::save},
      {{"create_file", Verb::ChangeFiles, {"path", "text", "robot_text", "robot_version"}},
       &FileVerbs::create},
      {{"rename_file", Verb::ChangeFiles, {"path", "to", "version", "robot_text", "robot_version"}},
       &FileVerbs::rename},
      {{"delete_file", Verb::ChangeFiles, {"path", "version", "robot_text", "robot_version"}},
       &FileVerbs::remove},
      {{"libraries", Verb::LookAtFiles, {"path"}}, &FileVerbs::libraries},
      {{"models", Verb::LookAtFiles, {}}, &FileVerbs::models},
      {{"semantic_data", Verb::LookAtFiles, {"path", "state"}}, &FileVerbs::semantic_data},
      {{"check_semantic_data", Verb::LookAtFiles, {"path", "state", "version", "edits"}},
       &FileVerbs::check_semantic_data},
      {{"save_semantic_data", Verb::ChangeFiles, {"path", "state", "version", "edits"}},
       &FileVerbs::save_semantic_data},
      {{"look_at_ros2", Verb::LookAtRos2, {"domain", "discovery"}}, &Ros2Looks::begin},
      {{"plan_files", Verb::Plan, {"force", "order", "timeout_s"}}, ask_plan},
      {{"apply_files", Verb::Apply, {"force", "order", "take_over", "timeout_s"}}, do_apply},
  };
  return entries;
}

const VerbEntry* find_verb(std::string_view name) {
  for (const VerbEntry& entry : verb_entries()) {
    if (entry.form.name == name) return &entry;
  }
  return nullptr;
}

}  // namespace

std::vector<VerbForm> verb_forms() {
  std::vector<VerbForm> forms;
  for (const VerbEntry& entry : verb_entries())
    forms.push_back(entry.form);
  return forms;
}

Verbs::Verbs(RobotLink& link, ModelsOf models, RunMission run, LookAtRos2 look)
    : link_(link),
      files_(link, std::move(models)),
      missions_(files_, std::move(run)),
      looks_(link, std::move(look)) {}

void Verbs::begin(Command command, Role role, const std::string& who, Answer answer) {
  const VerbEntry* entry = find_verb(command.verb());
  if (entry == nullptr) return answer(fail(ErrorCode::NotFound, "there is no verb " + quote(command.verb())));
  const Role needed = control::role_for(entry->form.verb, command.flag("take_over").value_or(false));
  if (role < needed) {
    return answer(fail(ErrorCode::PermissionDenied,
                       "this browser may only " + std::string(to_string(role)) + ", not " + command.verb() +
                           ", which needs the role " + std::string(to_string(needed))));
  }
  if (auto known = command.only(entry->form.arguments); !known) return answer(known.error());
  const bool observes = role == Role::Observe;
  if (observes && calls_of_observers_.fetch_add(1) >= kMostCallsOfObservers) {
    --calls_of_observers_;
    return answer(fail(ErrorCode::ResourceExhausted,
                       "too many calls of those who only observe are in progress; try again"));
  }
  auto shared = std::make_shared<Answer>(std::move(answer));
  concurrent::ThreadPool& pool = entry->form.verb == Verb::Stop ? stops_ : pool_;
  const bool accepted =
      pool.try_submit([this, command = std::move(command), user = PageUser{who, role}, shared, observes] {
        const auto leave = [&] {
          if (observes) --calls_of_observers_;
        };
        if (const auto* of_ros2 = std::get_if<OfRos2>(&find_verb(command.verb())->execute)) {
          leave();  // only one of those who ask keeps this thread
          return (looks_.**of_ros2)(command, *shared);
        }
        const auto result = execute(command, user);
        leave();
        (*shared)(result);
      });
  if (accepted) return;
  if (observes) --calls_of_observers_;
  (*shared)(fail(ErrorCode::ResourceExhausted, "too many calls are in progress; try again"));
}

Result<Value> Verbs::execute(const Command& command, const PageUser& user) {
  const VerbEntry& entry = *find_verb(command.verb());
  if (const auto* of_files = std::get_if<OfFiles>(&entry.execute)) return (files_.**of_files)(command);
  if (const auto* of_missions = std::get_if<OfMissions>(&entry.execute))
    return (missions_.**of_missions)(command, user);
  const auto link = link_.get();
  if (!link) return link.error();
  auto answer = std::get<OfRobot>(entry.execute)({*link->robot, command, user.who});
  if (!answer) link_.failed(link->generation, answer.error());
  return answer;
}

}  // namespace segue::web
