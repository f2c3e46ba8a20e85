// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/mission_script/script_worker.hpp>
#include <segue/type/value_at.hpp>

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <exception>
#include <limits>

namespace segue::mission::detail {

using type::Value;
using type::ValueMap;

namespace {

/// How long a process may take to end after it was asked to.
constexpr Duration kEndGrace = std::chrono::seconds(2);
/// Size of a read, and the number of reads after the process has ended, when its children may still write.
constexpr std::size_t kPiece = std::size_t{64} << 10U;
constexpr int kLastPieces = 64;

std::optional<std::uint64_t> number_of(const Value& message, std::string_view key) {
  const Value* value = message.find(key);
  if (value == nullptr || !value->is_integer()) return std::nullopt;
  return value->as_uint();
}

LogLevel level_of(const std::string& name) {
  for (const LogLevel level : {LogLevel::Debug, LogLevel::Warning, LogLevel::Error}) {
    if (name == to_string(level)) return level;
  }
  return LogLevel::Info;
}

Ending ending_of(const Value& message) {
  const Value* outcome = message.find("outcome");
  if (outcome == nullptr || !outcome->is_integer()) return {kAborted, text_at(message, "error")};
  const std::int64_t number = std::clamp<std::int64_t>(outcome->as_int(), std::numeric_limits<Outcome>::min(),
                                                       std::numeric_limits<Outcome>::max());
  return {static_cast<Outcome>(number), text_at(message, "error")};
}

}  // namespace

ScriptWorker::ScriptWorker(ScriptOptions options)
    : options_(std::move(options)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      messages_(options_.largest_message) {}

ScriptWorker::~ScriptWorker() {
  reach_->close();
  {
    const Lock guard(mutex_);
    open_ = false;
    closing_ = true;
    enqueue_text({});
  }
  if (thread_.joinable()) thread_.join();
}

bool ScriptWorker::begin(std::uint64_t id, ScriptExecution& execution, const std::string& message) {
  const Lock guard(mutex_);
  if (!open_) return false;
  if (!thread_.joinable()) thread_ = concurrent::start_thread("segue-script", [this] { run(); });
  executions_.emplace(id, std::move(execution));
  forget_released();
  for (const auto& [which, counts] : memory_->take_decisions())
    enqueue(Value::map({{"do", "decide"}, {"id", which}, {"counts", counts}}));
  enqueue_text(message);
  return true;
}

void ScriptWorker::preempt(std::uint64_t id) {
  const Lock guard(mutex_);
  const auto found = executions_.find(id);
  if (found == executions_.end() || found->second.overdue) return;
  found->second.overdue = monotonic_now() + options_.preemption_grace;
  if (found->second.robot) found->second.robot->preempt();
  enqueue(Value::map({{"do", "preempt"}, {"id", id}}));
}

void ScriptWorker::pause(bool paused) {
  const Lock guard(mutex_);
  enqueue(Value::map({{"do", "pause"}, {"paused", paused}}));
}

bool ScriptWorker::takes_more() const {
  const Lock guard(mutex_);
  return open_;
}

std::optional<pid_t> ScriptWorker::process() const {
  const Lock guard(mutex_);
  return pid_ == 0 ? std::nullopt : std::optional(pid_);
}

void ScriptWorker::run() {
  auto process = ScriptProcess::start(options_);
  if (process) {
    {
      const Lock guard(mutex_);
      pid_ = process->pid();
    }
    serve(*process);
    const std::string how = process->reap();
    abort_all(end_text(how));
  } else {
    abort_all(to_string(process.error()));
  }
  ended_ = true;
}

void ScriptWorker::serve(ScriptProcess& process) {
  ScriptProcess::Events events;
  while (!events.ended) {
    bool sending = false;
    {
      const Lock guard(mutex_);
      sending = sent_ < outgoing_.size();
    }
    events = process.wait(wake_.get(), sending, next_deadline());
    eventfd_t ignored = 0;
    (void)::eventfd_read(wake_.get(), &ignored);
    if (events.messages) read_messages(process);
    if (events.output) read_output(process);
    flush(process);
    check_time(process);
  }
  for (int i = 0; i < kLastPieces && read_messages(process); ++i) {
  }
  for (int i = 0; i < kLastPieces && read_output(process); ++i) {
  }
  if (const std::string rest = lines_.rest(); !rest.empty()) log(LogLevel::Info, "python", last_line_ = rest);
}

void ScriptWorker::flush(const ScriptProcess& process) {
  const Lock guard(mutex_);
  while (sent_ < outgoing_.size()) {
    const std::size_t count = process.send(std::string_view(outgoing_).substr(sent_));
    if (count == 0) return;
    sent_ += count;
  }
  outgoing_.clear();
  sent_ = 0;
}

/// False if nothing was available.
bool ScriptWorker::read_messages(ScriptProcess& process) {
  std::array<char, kPiece> buffer;
  std::string_view text;
  const auto read = process.read_messages(buffer, text);
  // A process that has just died has closed its end too; its pidfd will report that in a moment.
  if (read == ScriptProcess::Read::End && !killed_ && !asked_to_end_)
    kill_at(monotonic_now() + kEndGrace, "it had closed its connection");
  if (read != ScriptProcess::Read::Some) return false;
  if (broken_) return true;
  messages_.append(text);
  for (;;) {
    auto message = messages_.next();
    if (!message) {
      refuse("it sent an invalid message: " + to_string(message.error()));
      return true;
    }
    if (!*message) return true;
    handle(**message);
  }
}

bool ScriptWorker::read_output(ScriptProcess& process) {
  std::array<char, kPiece> buffer;
  std::string_view text;
  if (process.read_output(buffer, text) != ScriptProcess::Read::Some) return false;
  lines_.append(text);
  while (auto line = lines_.next()) {
    log(LogLevel::Info, "python", *line);
    if (!line->empty()) last_line_ = std::move(*line);
  }
  return true;
}

void ScriptWorker::handle(const Value& message) {
  const std::string what = text_at(message, "do");
  if (what == "end") {
    handle_end(message);
  } else if (what == "ask") {
    handle_question(message);
  } else if (what == "log") {
    const std::string path = text_at(message, "path");
    log(level_of(text_at(message, "level")), path.empty() ? "python" : path, text_at(message, "text"));
  } else {
    refuse("it sent an unknown message");
  }
}

void ScriptWorker::handle_end(const Value& message) {
  Lock guard(mutex_);
  const auto found = executions_.find(number_of(message, "id").value_or(0));
  if (found == executions_.end()) {
    guard.unlock();
    return refuse("it ended an execution that it had not been given");
  }
  ScriptExecution execution = std::move(found->second);
  executions_.erase(found);
  guard.unlock();
  show_objects(message);
  const Value* written = message.find("outputs");
  for (std::size_t i = 0; written != nullptr && i < execution.outputs.size(); ++i) {
    if (const Value* value = written->find(execution.output_names[i])) execution.outputs[i] = *value;
  }
  Ending ending = ending_of(message);
  if (const auto from = number_of(message, "memory")) {
    ending.memory = number_of(message, "id").value_or(0);
    ending.pending =
        ScriptMemory::changes(memory_, {execution.path, ending.memory, *from, execution.is_told_memory});
  }
  complete(std::move(execution), std::move(ending));
}

/// Passes on the values that the objects show now which the execution has used.
void ScriptWorker::show_objects(const Value& message) {
  const Value* shown = message.find("objects");
  if (shown == nullptr || !shown->is_list()) return;
  for (const Value& each : shown->as_list()) {
    const auto number = number_of(each, "number");
    const Value* value = each.find("value");
    if (number && value != nullptr) objects_->show(*number, *value);
  }
}

/// Once it uses the robot no more.
void ScriptWorker::complete(ScriptExecution execution, Ending ending) {
  const auto robot = std::move(execution.robot);
  auto ended = [completer = std::move(execution.completer), outputs = std::move(execution.outputs)](
                   Ending with) mutable { completer(std::move(with), std::move(outputs)); };
  if (robot == nullptr) return ended(std::move(ending));
  robot->end(std::move(ending), std::move(ended));
}

void ScriptWorker::handle_question(const Value& message) {
  Lock guard(mutex_);
  const auto found = executions_.find(number_of(message, "execution").value_or(0));
  const std::string about = text_at(message, "about");
  if (about == "data" && found != executions_.end() && found->second.data) {
    const auto data = found->second.data;
    guard.unlock();
    return answer(data->answer(message), number_of(message, "number").value_or(0));
  }
  const bool of_robot = about == "robot";
  if (of_robot && found != executions_.end() && found->second.robot) {
    const auto robot = found->second.robot;
    guard.unlock();
    return ask_robot(robot, message);
  }
  ValueMap reply;
  if (found == executions_.end() || of_robot) {
    const std::string what = of_robot ? "the robot" : "global variables";
    reply.append("error", found == executions_.end() ? what + " cannot be used after the end of execute()"
                                                     : "the script may not use the robot");
    reply.append("code", "invalid-state");
  } else {
    reply = answer_about_globals(found->second.globals, objects_, message);
    const Value* value = reply.find("value");
    if (text_at(message, "call") == "lock" && value != nullptr && value->is_integer())
      found->second.locks.emplace_back(text_at(message, "name"), value->as_uint());
  }
  guard.unlock();
  answer(std::move(reply), number_of(message, "number").value_or(0));
}

void ScriptWorker::ask_robot(const std::shared_ptr<ScriptRobot::Use>& robot, const Value& message) {
  const std::uint64_t number = number_of(message, "number").value_or(0);
  robot->ask(message, [reach = reach_, number](ValueMap reply) {
    reach->with([&](ScriptWorker& worker) { worker.answer(std::move(reply), number); });
  });
}

void ScriptWorker::answer(ValueMap reply, std::uint64_t number) {
  reply.append("do", "answer");
  reply.append("number", number);
  const Lock guard(mutex_);
  enqueue(std::move(reply));
  forget_released();
}

/// If scripts have ignored their preemption, the worker accepts no others, and is killed once only such
/// scripts are left.
void ScriptWorker::retire_overdue(TimePoint now) {
  const auto overdue = [&](const auto& each) { return each.second.overdue && *each.second.overdue <= now; };
  const auto late = std::ranges::find_if(executions_, overdue);
  if (late == executions_.end() || killed_) return;
  if (std::exchange(open_, false)) {
    log(LogLevel::Warning, late->second.path,
        "it ignored its preemption; further scripts start in a new process");
  }
  if (std::ranges::all_of(executions_, overdue)) kill_at(now, "it ignored its preemption");
}

void ScriptWorker::check_time(const ScriptProcess& process) {
  const TimePoint now = checked_ = monotonic_now();
  {
    const Lock guard(mutex_);
    retire_overdue(now);
    const bool idle = executions_.empty();
    if (!asked_to_end_ && (closing_ || (!open_ && idle))) {
      asked_to_end_ = true;
      process.end_messages();
      kill_at(idle ? now + kEndGrace : now, "nothing waits for it any longer");
    }
  }
  if (!kill_at_ || *kill_at_ > now || killed_) return;
  killed_ = true;
  process.kill();
}

std::optional<TimePoint> ScriptWorker::next_deadline() const {
  if (killed_) return std::nullopt;
  std::optional<TimePoint> next = kill_at_;
  const Lock guard(mutex_);
  for (const auto& [id, execution] : executions_) {
    if (execution.overdue && *execution.overdue > checked_)
      next = std::min(next.value_or(*execution.overdue), *execution.overdue);
  }
  return next;
}

/// After an invalid message the rest of the stream cannot be interpreted.
void ScriptWorker::refuse(const std::string& reason) {
  broken_ = true;
  kill_at(monotonic_now(), reason);
}

/// Kills the process at that time; of several calls, the earliest time and its reason count.
void ScriptWorker::kill_at(TimePoint when, const std::string& reason) {
  if (killed_ || (kill_at_ && *kill_at_ <= when)) return;
  kill_at_ = when;
  kill_reason_ = reason;
}

std::string ScriptWorker::end_text(const std::string& how) const {
  if (killed_) return "the Python process was killed, since " + kill_reason_;
  std::string text = "the Python process " + how;
  if (!last_line_.empty()) text += "; its last output: " + last_line_;
  return text;
}

/// Aborts the remaining executions and releases their locks, whose keys only this side still has.
void ScriptWorker::abort_all(const std::string& error) {
  memory_->end();
  objects_->end();
  std::map<std::uint64_t, ScriptExecution> left;
  {
    const Lock guard(mutex_);
    open_ = false;
    pid_ = 0;
    left.swap(executions_);
  }
  for (auto& [id, execution] : left) {
    for (const auto& [name, key] : execution.locks)
      (void)execution.globals.unlock(name, key);
    complete(std::move(execution), {kAborted, error});
  }
}

void ScriptWorker::forget_released() {
  const auto released = objects_->take_released();
  if (!released.empty())
    enqueue(Value::map({{"do", "forget"}, {"objects", Value::List(released.begin(), released.end())}}));
}

void ScriptWorker::enqueue(const Value& message) {
  auto text = framed(message, options_.largest_message);
  if (text) return enqueue_text(*text);
  const Value* number = message.find("number");
  const Value refusal = Value::map({{"do", "answer"},
                                    {"number", number == nullptr ? Value() : *number},
                                    {"error", text.error().message},
                                    {"code", "resource-exhausted"}});
  if (auto shorter = framed(refusal, std::numeric_limits<std::size_t>::max())) enqueue_text(*shorter);
}

void ScriptWorker::enqueue_text(std::string_view text) {
  outgoing_ += text;
  (void)::eventfd_write(wake_.get(), 1);
}

}  // namespace segue::mission::detail
