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
#include <utility>

#include "command.hpp"
#include "output.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;

constexpr Duration kLogPause = std::chrono::milliseconds(100);

/// How long a host may take to answer.
constexpr Duration kHostPatience = std::chrono::seconds(5);

struct LogOptions {
  std::string process;
  std::string robot_file;  ///< of a robot whose host has the process
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

Error nothing_printed(const LogOptions& options, const std::vector<fs::path>& logs) {
  std::vector<std::string> names;
  for (const fs::path& log : logs)
    names.push_back(process_of(log));
  return fail(ErrorCode::NotFound,
              fmt::format("there is no output of process {}{}; there is output of {}", quote(options.process),
                          did_you_mean(options.process, names), names.empty() ? "none" : listed(names)));
}

Result<fs::path> find_log(const LogOptions& options, const std::string& robot) {
  const auto folder = runtime_folder();
  if (!folder) return folder.error();
  const auto logs = logs_of(*folder, robot);
  std::vector<fs::path> found;
  std::vector<std::string> robots;
  for (const fs::path& log : logs) {
    if (process_of(log) != options.process) continue;
    found.push_back(log);
    robots.push_back(log.parent_path().filename().string());
  }
  if (found.empty()) return nothing_printed(options, logs);
  if (found.size() == 1) return found.front();
  return fail(ErrorCode::InvalidArgument,
              fmt::format("robots {} have a process {}; select one with --robot NAME", listed(robots),
                          quote(options.process)));
}

/// Assembles lines from pieces of output.
class LinePrinter {
 public:
  explicit LinePrinter(const Context& context) : context_(context) {}
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
    context_.json() ? print_json_line(type::Value::map({{"line", line}})) : print_line(printable(line));
  }

  const Context& context_;
  std::string rest_;
};

/// Gives the last lines, or what comes after a position.
using ReadLog =
    std::function<Result<process_server::LogPart>(const std::optional<process_server::LogPosition>& after)>;

Result<ReadLog> log_here(const LogOptions& options, const std::string& robot) {
  auto log = find_log(options, robot);
  if (!log) return log.error();
  return ReadLog([log = std::move(*log), lines = options.lines](const auto& after) {
    return after ? process_server::log_after(log, *after) : process_server::log_tail(log, lines);
  });
}

/// The log of a process that is called "host/process", from the daemon of its host.
Result<ReadLog> log_at_host(const LogOptions& options) {
  const auto slash = options.process.find('/');
  if (slash == std::string::npos) {
    return fail(ErrorCode::InvalidArgument,
                "with --hosts a process is called HOST/PROCESS, as `segue status` shows it");
  }
  Diagnostics diagnostics;
  const auto robot = model::load_robot(options.robot_file, diagnostics);
  if (!robot) return diagnostics.to_error();
  const model::HostName name(options.process.substr(0, slash));
  std::vector<std::string> known;
  for (const auto& place : runtime::host_places(*robot)) {
    known.push_back(place.name.str());
    if (place.name != name) continue;
    auto connected = place.connect(RealClock::instance().now() + kHostPatience, {});
    if (!connected) return connected.error();
    distributed::LogRequest request{
        robot->name, model::ProcessName(options.process.substr(slash + 1)), options.lines, {}};
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

int show_log(const LogOptions& options, const Context& context) {
  const auto read = options.robot_file.empty() ? log_here(options, context.robot) : log_at_host(options);
  if (!read) return failed(context, read.error());
  auto part = (*read)(std::nullopt);
  if (!part) return failed(context, part.error());
  LinePrinter printer(context);
  printer.add(part->text);
  while (options.follow) {
    auto more = (*read)(part->end);
    if (!more && more.error().code != ErrorCode::NotFound) {  // while it is rotated there may be none
      printer.finish();
      return failed(context, more.error());
    }
    bool has_grown = false;
    if (more) {
      part = std::move(more);
      printer.add(part->text);
      has_grown = !part->text.empty();
    }
    if (reader_leaves_within(has_grown ? Duration(0) : kLogPause)) break;
  }
  printer.finish();
  return kDone;
}

}  // namespace

void add_log(Verb& app, Context& context) {
  const auto options = std::make_shared<LogOptions>();
  Verb& verb = add_verb(app, context, "log", "show the output of a deployment process, running or not",
                        "  segue log drivers\n  segue log drivers --lines 200 --follow\n"
                        "  segue log arm/drivers --hosts robot.yaml",
                        [options, &context] { return show_log(*options, context); });
  verb.option("PROCESS", options->process, "the process's name").required();
  verb.option("-n,--lines N", options->lines, "the number of lines from the end (default 50)")
      .between(0, kMostLines);
  verb.flag("-f,--follow", options->follow, "follow new output until Ctrl-C");
  verb.option("--robot NAME", context.robot, "the robot's name; needed if several robots have that process");
  verb.option("--hosts ROBOT_FILE", options->robot_file,
              "the robot file with the host of the process, which is called HOST/PROCESS then");
}

}  // namespace segue::cli
