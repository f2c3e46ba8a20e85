// SPDX-License-Identifier: Apache-2.0
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/runtime/host_places.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "../connection.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;

constexpr Duration kLogPause = std::chrono::milliseconds(100);

/// How long a host may take to answer.
constexpr Duration kHostPatience = std::chrono::seconds(5);

struct LogOptions {
  std::vector<std::string> processes;  ///< empty: all
  std::string robot_file;              ///< of a robot whose hosts have the processes
  std::size_t lines = 50;
  bool follow = false;
};

/// Logs of the robot, or of all robots where `robot` is empty. Robots need not run.
std::vector<fs::path> logs_of(const fs::path& folder, const std::string& robot) {
  std::vector<fs::path> logs;
  std::error_code failed;
  for (fs::directory_iterator place(folder, failed), end; !failed && place != end; place.increment(failed)) {
    if (!robot.empty() && place->path().filename() != robot) continue;
    std::error_code ignored;
    for (const auto& file : fs::directory_iterator(place->path(), ignored)) {
      if (file.path().extension() == ".log") logs.push_back(file.path());
    }
  }
  std::sort(logs.begin(), logs.end());
  return logs;
}

std::string process_of(const fs::path& log) {
  return log.stem().string();
}

Error nothing_printed(const std::string& process, const std::vector<fs::path>& logs) {
  std::vector<std::string> names;
  for (const fs::path& log : logs)
    names.push_back(process_of(log));
  return fail(ErrorCode::NotFound,
              fmt::format("there is no output of process {}{}; there is output of {}", quote(process),
                          did_you_mean(process, names), names.empty() ? "none" : listed(names)));
}

Result<fs::path> find_log(const std::string& process, const std::vector<fs::path>& logs) {
  std::vector<fs::path> found;
  std::vector<std::string> robots;
  for (const fs::path& log : logs) {
    if (process_of(log) != process) continue;
    found.push_back(log);
    robots.push_back(log.parent_path().filename().string());
  }
  if (found.empty()) return nothing_printed(process, logs);
  if (found.size() == 1) return found.front();
  return fail(ErrorCode::InvalidArgument,
              fmt::format("robots {} have a process {}; select one with --robot NAME", listed(robots),
                          quote(process)));
}

/// Assembles lines from pieces of output.
class LinePrinter {
 public:
  /// `name` stands before each line; empty: nothing does.
  LinePrinter(std::string name, const Context& context) : name_(std::move(name)), context_(context) {}
  void add(const std::string& text) {
    rest_ += text;
    std::size_t begin = 0;
    for (auto end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n', begin)) {
      show(rest_.substr(begin, end - begin));
      begin = end + 1;
    }
    rest_.erase(0, begin);
  }
  void finish() {
    if (!rest_.empty()) show(std::exchange(rest_, {}));
  }

 private:
  void show(const std::string& line) {
    if (!context_.json()) return print_line((name_.empty() ? "" : name_ + " | ") + printable(line));
    type::Value value = type::Value::map({{"line", line}});
    if (!name_.empty()) value.as_map().set("process", name_);
    print_json_line(value);
  }

  const std::string name_;
  const Context& context_;
  std::string rest_;
};

/// Gives the last lines, or what comes after a position.
using ReadLog =
    std::function<Result<process_server::LogPart>(const std::optional<process_server::LogPosition>& after)>;

/// The output of a process, and how far it has been shown.
struct FollowedLog {
  std::string process;
  ReadLog read;
  std::optional<process_server::LogPosition> end{};
};

ReadLog reader_of(const fs::path& log, std::size_t lines) {
  return [log, lines](const auto& after) {
    return after ? process_server::log_after(log, *after) : process_server::log_tail(log, lines);
  };
}

/// The named processes, or all of the robot that runs; where none runs, of the only one there is output of.
Result<std::vector<FollowedLog>> logs_here(const LogOptions& options, std::string robot) {
  const auto folder = runtime_folder();
  if (!folder) return folder.error();
  if (const auto running = control::running_robots(); robot.empty() && running.size() == 1)
    robot = running.front();
  const auto logs = logs_of(*folder, robot);
  std::vector<FollowedLog> found;
  for (const std::string& process : options.processes) {
    const auto log = find_log(process, logs);
    if (!log) return log.error();
    found.push_back({process, reader_of(*log, options.lines)});
  }
  if (!options.processes.empty()) return found;
  std::set<std::string> robots;
  for (const fs::path& log : logs) {
    robots.insert(log.parent_path().filename().string());
    found.push_back({process_of(log), reader_of(log, options.lines)});
  }
  if (found.empty()) {
    return fail(ErrorCode::NotFound,
                "there is no output of any process; tasks that have no process of their own "
                "write to the terminal of `segue run`");
  }
  if (robots.size() > 1) {
    return fail(ErrorCode::InvalidArgument, "there is output of robots " +
                                                listed(std::vector(robots.begin(), robots.end())) +
                                                "; select one with --robot NAME");
  }
  return found;
}

/// The log of a process that is called "host/process", from the daemon of its host.
Result<ReadLog> log_at_host(const std::string& process, const model::Robot& robot, std::size_t lines) {
  const auto slash = process.find('/');
  if (slash == std::string::npos) {
    return fail(ErrorCode::InvalidArgument,
                "with --hosts a process is called HOST/PROCESS, as `segue status` shows it");
  }
  const model::HostName name(process.substr(0, slash));
  std::vector<std::string> known;
  for (const auto& place : runtime::host_places(robot)) {
    known.push_back(place.name.str());
    if (place.name != name) continue;
    auto connected = place.connect(RealClock::instance().now() + kHostPatience, {});
    if (!connected) return connected.error();
    distributed::LogRequest request{robot.name, model::ProcessName(process.substr(slash + 1)), lines, {}};
    return ReadLog([service = std::shared_ptr<distributed::HostService>(std::move(*connected)),
                    request = std::move(request)](const auto& after) mutable {
      request.after = after;
      return service->log(request);
    });
  }
  return fail(ErrorCode::NotFound, "the robot has no host " + quote(name.str()) +
                                       did_you_mean(name.str(), known) + "; it has " +
                                       (known.empty() ? "none" : listed(known)));
}

/// "HOST/PROCESS" of all processes on other hosts that have tasks of the running robot.
Result<std::vector<std::string>> processes_at_hosts(const std::string& robot) {
  const auto service = connect_to(robot);
  const auto status = service ? (*service)->status() : Result<type::Value>(service.error());
  if (!status) return status.error();
  std::set<std::string> processes;
  for (const type::Value& task : list_at(*status, "tasks")) {
    if (const std::string host = printable_at(task, "host"); !host.empty() && host != model::kLocalHost.str())
      processes.insert(host + "/" + printable_at(task, "process"));
  }
  return std::vector(processes.begin(), processes.end());
}

Result<std::vector<FollowedLog>> logs_at_hosts(const LogOptions& options, const Context& context) {
  Diagnostics diagnostics;
  const auto robot = model::load_robot(options.robot_file, diagnostics);
  if (!robot) return diagnostics.to_error();
  std::vector<FollowedLog> found;
  std::vector<std::string> processes = options.processes;
  if (processes.empty()) {
    auto all = processes_at_hosts(robot->name);
    if (!all) return all.error();
    processes = std::move(*all);
    if (auto here = logs_here(options, context.robot.empty() ? robot->name : context.robot))
      found = std::move(*here);
  }
  for (const std::string& process : processes) {
    auto read = log_at_host(process, *robot, options.lines);
    if (!read) return read.error();
    found.push_back({process, std::move(*read)});
  }
  return found;
}

/// Shows what has come since the last call. Whether there was something.
Result<bool> show_more(FollowedLog& log, LinePrinter& printer) {
  auto part = log.read(log.end);
  if (!part) {
    // While it is rotated there may be none.
    if (log.end && part.error().code == ErrorCode::NotFound) return false;
    printer.finish();
    return part.error();
  }
  log.end = part->end;
  printer.add(part->text);
  return !part->text.empty();
}

int show_logs(const LogOptions& options, const Context& context) {
  auto logs =
      options.robot_file.empty() ? logs_here(options, context.robot) : logs_at_hosts(options, context);
  if (!logs) return failed(context, logs.error());
  std::vector<LinePrinter> printers;
  for (const FollowedLog& log : *logs)
    printers.emplace_back(logs->size() > 1 ? log.process : "", context);
  do {
    bool has_grown = false;
    for (std::size_t i = 0; i < logs->size(); ++i) {
      const auto grown = show_more(logs->at(i), printers[i]);
      if (!grown) return failed(context, grown.error());
      has_grown |= *grown;
    }
    if (options.follow && reader_leaves_within(has_grown ? Duration(0) : kLogPause)) break;
  } while (options.follow);
  for (LinePrinter& printer : printers)
    printer.finish();
  return kDone;
}

}  // namespace

void add_log(Verb& app, Context& context) {
  const auto options = std::make_shared<LogOptions>();
  Verb& verb =
      add_verb(app, context, "log", "show the output of deployment processes, running or not",
               "  segue log --follow                 # of all processes of the robot\n"
               "  segue log drivers vision --lines 200\n"
               "  segue log arm/drivers --hosts robot.yaml\n"
               "  segue log --follow --hosts robot.yaml   # of all processes here and on other hosts",
               [options, &context] { return show_logs(*options, context); });
  verb.option("PROCESS", options->processes, "names of processes (default: all of the robot)");
  verb.option("-n,--lines N", options->lines, "the number of lines from the end (default 50)")
      .between(0, kMostLines);
  verb.flag("-f,--follow", options->follow, "follow new output until Ctrl-C");
  verb.option("--robot NAME", context.robot, "the robot's name; needed if several robots have that process");
  verb.option("--hosts ROBOT_FILE", options->robot_file,
              "the robot file with the hosts of the processes, which are called HOST/PROCESS then");
}

}  // namespace segue::cli
