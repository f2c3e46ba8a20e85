// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <memory>

#include "../connection.hpp"
#include "health_text.hpp"
#include "task_table.hpp"
#include "top_page.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct TopOptions {
  bool once = false;
  Duration interval = std::chrono::seconds(1);
  std::string sort;  ///< empty: by "cpu", with --once as the robot lists them
};

constexpr std::array kEndingSignals = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

/// The terminal before Keyboard changed it; at namespace scope for the signal handler.
termios terminal_before{};

extern "C" void restore_terminal_and_end(int signal) {
  ::tcsetattr(STDIN_FILENO, TCSANOW, &terminal_before);
  ::signal(signal, SIG_DFL);
  ::raise(signal);  // takes effect when this handler returns
}

/// Hears keys at once and does not show them, while standard input is a terminal that is ours. The terminal
/// is as before after its end, and after a signal that ends the process. One at a time.
class Keyboard {
 public:
  Keyboard() {
    heard_ = ::tcgetpgrp(STDIN_FILENO) == ::getpgrp() && ::tcgetattr(STDIN_FILENO, &terminal_before) == 0;
    if (!heard_) return;
    for (const int signal : kEndingSignals)
      ::signal(signal, restore_terminal_and_end);
    termios changed = terminal_before;
    changed.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ::tcsetattr(STDIN_FILENO, TCSANOW, &changed);
    changed_ = true;
  }
  ~Keyboard() {
    if (!changed_) return;
    ::tcsetattr(STDIN_FILENO, TCSANOW, &terminal_before);
    for (const int signal : kEndingSignals)
      ::signal(signal, SIG_DFL);
  }
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  /// Whether `q` is typed, or nobody reads standard output any more; waits for that at most `limit`.
  bool leaves_within(Duration limit) {
    const TimePoint end = deadline_in(limit);
    for (Duration left = limit; left > Duration(0); left = end - RealClock::instance().now()) {
      std::array<pollfd, 2> waited = {{{STDOUT_FILENO, 0, 0}, {heard_ ? STDIN_FILENO : -1, POLLIN, 0}}};
      const auto whole = std::chrono::floor<std::chrono::seconds>(left);
      const timespec timeout{whole.count(), (left - whole).count()};
      if (::ppoll(waited.data(), waited.size(), &timeout, nullptr) <= 0) continue;
      if (waited[0].revents != 0) return true;
      std::array<char, 64> typed{};
      const auto count = ::read(STDIN_FILENO, typed.data(), typed.size());
      heard_ = count > 0;
      if (heard_ && std::find(typed.begin(), typed.begin() + count, 'q') != typed.begin() + count)
        return true;
    }
    return false;
  }

 private:
  bool heard_ = false;
  bool changed_ = false;
};

std::string top_text(const Value& status) {
  return top_heading(status) + '\n' + task_table(status, true);
}

/// If the status of a runtime has no processor times, they are taken from the report of each task.
void add_processor_times(control::RobotService& robot, Value& status) {
  Value* tasks = status.is_map() ? status.as_map().find("tasks") : nullptr;
  if (tasks == nullptr || !tasks->is_list()) return;
  for (Value& task : tasks->as_list()) {
    if (task.find("cpu_us") != nullptr) continue;
    const auto report = robot.task(printable_at(task, "id"));  // may have been removed since
    const Value* timing = report ? report->find("timing") : nullptr;
    if (timing != nullptr && task.is_map()) task.as_map().set("cpu_us", number_at(*timing, "cpu_us"));
  }
}

int show_once(control::RobotService& robot, const TopOptions& options, const Context& context) {
  auto status = robot.status();
  if (!status) return failed(context, status.error());
  add_processor_times(robot, *status);
  if (!options.sort.empty()) sort_tasks(*status, options.sort, {});
  context.json() ? print_json(*status) : print(top_text(*status));
  return kDone;
}

int show_pages(control::RobotService& robot, const TopOptions& options, const Context& context) {
  Keyboard keyboard;
  const std::string sort = options.sort.empty() ? std::string("cpu") : options.sort;
  ProcessorShares shares;
  do {
    auto status = robot.status();
    if (!status) return failed(context, status.error());
    add_processor_times(robot, *status);
    shares.look_at(*status, RealClock::instance().now());
    sort_tasks(*status, sort, shares);
    const PageSize size{terminal_columns(STDOUT_FILENO), terminal_rows(STDOUT_FILENO)};
    print(std::string(kClearScreen) + top_page(*status, shares, size));
    print_line(coloured(Colour::Dim, "q quits; tasks by " + sort));
  } while (!keyboard.leaves_within(options.interval));
  return kDone;
}

}  // namespace

void add_top(Verb& app, Context& context) {
  const auto options = std::make_shared<TopOptions>();
  Verb& verb =
      add_verb(app, context, "top", "show the state of a robot and the timing of its tasks continuously",
               "  segue top\n  segue top --sort worst\n  segue top --once", [options, &context] {
                 const bool once = options->once || context.json() || !output_is_terminal();
                 return with_robot(context, [&](control::RobotService& robot) {
                   return (once ? show_once : show_pages)(robot, *options, context);
                 });
               });
  verb.flag("--once", options->once,
            "print all tasks once and exit; the default if the output is not a terminal");
  verb.option("--interval DURATION", options->interval, "time between refreshes (default 1s)")
      .between(std::chrono::milliseconds(10), std::chrono::hours(24));
  verb.option("--sort KEY", options->sort,
              "the order of tasks: cpu (processor time lately; the default), name, worst, latency or missed")
      .one_of({"cpu", "name", "worst", "latency", "missed"});
  add_robot_option(verb, context);
}

}  // namespace segue::cli
