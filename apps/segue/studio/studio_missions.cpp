// SPDX-License-Identifier: Apache-2.0
#include "studio_missions.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/pipe.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/type/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <utility>

namespace segue::cli {

namespace {

using type::Value;

/// More of what a process prints is dropped.
constexpr std::size_t kMostOutput = std::size_t{16} << 20;
/// A mission that is preempted may handle that, and its robot comes to rest; together that takes seconds, as
/// a rule.
constexpr Duration kEndPatience = std::chrono::minutes(3);
/// In which a listener looks whether it shall stop.
constexpr Duration kListenPeriod = std::chrono::milliseconds(200);

std::vector<std::string> words_for(const web::MissionOrder& order, const std::string& robot) {
  std::vector<std::string> words = {"segue",       "mission",  "run", order.file.string(),
                                    "--until-eof", "--format", "json"};
  const auto add = [&words](std::initializer_list<const char*> more) {
    words.insert(words.end(), more.begin(), more.end());
  };
  add({"--mode", order.mode == web::MissionMode::Sequential ? "sequential" : "concurrent"});
  if (order.mode == web::MissionMode::Strict) add({"--strict"});
  for (const auto& [name, value] : order.inputs)
    words.push_back("--input=" + name + "=" + type::to_json(value, -1));
  if (order.simulate) {
    add({"--simulate", "--clock", "virtual"});
    return words;
  }
  add({"--follow", "--through-robot"});
  words.insert(words.end(), {"--robot=" + robot, "--for=" + order.who});
  if (order.steps_back) add({"--steps-back"});
  return words;
}

std::string text_in(const Value& value, std::string_view key) {
  const Value* text = value.find(key);
  return text != nullptr && text->is_string() ? text->as_string() : std::string();
}

/// The error that `segue` has printed as JSON, with what caused it, or the first of its diagnostics.
Error error_in(const std::string& output) {
  const auto document = type::parse_json(output);
  const Value* error = document ? document->find("error") : nullptr;
  std::string message;
  for (; error != nullptr; error = error->find("cause")) {
    if (const std::string text = text_in(*error, "message"); !text.empty())
      message += (message.empty() ? "" : ": ") + text;
  }
  const Value* problems = document ? document->find("diagnostics") : nullptr;
  if (message.empty() && problems != nullptr && problems->is_list()) {
    for (const Value& one : problems->as_list()) {
      if (message.empty() && text_in(one, "severity") == "error") message = text_in(one, "message");
    }
  }
  if (message.empty()) message = "it ended before it had begun; the terminal of the studio may say why";
  return fail(ErrorCode::InvalidState, "the mission was not started: " + message);
}

}  // namespace

Result<std::unique_ptr<MissionProcess>> MissionProcess::start(std::vector<std::string> words) {
  auto input = make_pipe();
  if (!input) return std::move(input.error());
  auto output = make_pipe();
  if (!output) return std::move(output.error());
  ChildProcess child(STDERR_FILENO + 1);
  const std::pair<int, int> given[] = {{input->read.get(), STDIN_FILENO},
                                       {output->write.get(), STDOUT_FILENO},
                                       {STDERR_FILENO, STDERR_FILENO}};
  for (const auto& [source, number] : given) {
    if (auto handed = child.hand_over(source, number); !handed) return std::move(handed.error());
  }
  const auto pid = child.start("/proc/self/exe", std::move(words), "the mission: ");
  if (!pid) return pid.error();
  return std::unique_ptr<MissionProcess>(
      new MissionProcess(*pid, std::move(input->write), std::move(output->read)));
}

MissionProcess::MissionProcess(pid_t pid, Descriptor input, Descriptor output)
    : pid_(pid), output_end_(std::move(output)), input_(std::move(input)) {
  listener_ = concurrent::start_stoppable_thread("segue-mission",
                                                 [this](const std::stop_token& stop) { listen(stop); });
}

MissionProcess::~MissionProcess() {
  ask_to_end();
  (void)wait_for_end(RealClock::instance().now() + kEndPatience);
  listener_.request_stop();
}

void MissionProcess::ask_to_end() {
  const Lock lock(mutex_);
  input_ = Descriptor();
}

bool MissionProcess::has_ended() const {
  const Lock lock(mutex_);
  return ended_;
}

bool MissionProcess::wait_for_line(TimePoint deadline) const {
  Lock lock(mutex_);
  return changed_.wait_until(mutex_, deadline, [this]() SEGUE_REQUIRES(mutex_) {
    return ended_ || output_.find('\n') != std::string::npos;
  });
}

bool MissionProcess::wait_for_end(TimePoint deadline) const {
  Lock lock(mutex_);
  return changed_.wait_until(mutex_, deadline, [this]() SEGUE_REQUIRES(mutex_) { return ended_; });
}

std::string MissionProcess::output() const {
  const Lock lock(mutex_);
  return output_;
}

void MissionProcess::forget_output() {
  const Lock lock(mutex_);
  keeps_output_ = false;
  output_ = std::string();
}

/// Reads all that it prints, so that it never waits for a reader.
void MissionProcess::listen(const std::stop_token& stop) {
  std::array<char, 65536> read{};
  while (!stop.stop_requested()) {
    if (!wait_for_input(output_end_.get(), kListenPeriod)) continue;
    const auto count = ::read(output_end_.get(), read.data(), read.size());
    if (count <= 0) break;
    const Lock lock(mutex_);
    if (keeps_output_)
      output_.append(read.data(), std::min(static_cast<std::size_t>(count), kMostOutput - output_.size()));
    changed_.notify_all();
  }
  segue::wait_for_end(pid_, stop.stop_requested() ? Duration(0) : kEndPatience);
  const Lock lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

Result<std::shared_ptr<MissionProcess>> StudioMissions::start(const web::MissionOrder& order) {
  std::list<std::shared_ptr<MissionProcess>> over;  // end outside of the lock
  const Lock lock(mutex_);
  if (closed_) return fail(ErrorCode::Unavailable, "the studio ends");
  for (auto at = processes_.begin(); at != processes_.end();) {
    const auto next = std::next(at);
    if ((*at)->has_ended()) over.splice(over.end(), processes_, at);
    at = next;
  }
  auto started = MissionProcess::start(words_for(order, robot_));
  if (!started) return std::move(started.error());
  processes_.push_back(std::move(*started));
  return processes_.back();
}

Result<Value> StudioMissions::run(const web::MissionOrder& order, TimePoint deadline) {
  const auto started = start(order);
  if (!started) return started.error();
  MissionProcess& process = **started;
  const bool in_time = order.simulate ? process.wait_for_end(deadline) : process.wait_for_line(deadline);
  if (!in_time) {
    process.ask_to_end();
    return fail(ErrorCode::DeadlineExceeded, order.simulate
                                                 ? "the simulation did not end in time, so it was stopped"
                                                 : "the mission did not begin in time, so it was stopped");
  }
  const std::string output = process.output();
  if (order.simulate) {
    auto document = type::parse_json(output);
    return document && document->find("nodes") != nullptr ? std::move(document) : error_in(output);
  }
  // Events come one a line, an error over several.
  const auto event = type::parse_json(output.substr(0, output.find('\n')));
  if (event && event->find("kind") != nullptr) {
    process.forget_output();
    return Value();
  }
  (void)process.wait_for_end(deadline);
  return error_in(process.output());
}

void StudioMissions::end() {
  std::list<std::shared_ptr<MissionProcess>> all;
  {
    const Lock lock(mutex_);
    closed_ = true;
    all.swap(processes_);
  }
  for (const auto& process : all)
    process->ask_to_end();
  const TimePoint deadline = RealClock::instance().now() + kEndPatience;
  for (const auto& process : all)
    (void)process->wait_for_end(deadline);
}

std::size_t StudioMissions::running() const {
  const Lock lock(mutex_);
  return static_cast<std::size_t>(
      std::ranges::count_if(processes_, [](const auto& process) { return !process->has_ended(); }));
}

}  // namespace segue::cli
