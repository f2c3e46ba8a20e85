// SPDX-License-Identifier: Apache-2.0
#include <segue/planner/planner_process.hpp>

#include <segue/base/child_process.hpp>
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/base/trimmed.hpp>

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

namespace segue::planner {

namespace {

using std::filesystem::path;

constexpr int kLargestFile = 64'000'000;
constexpr std::string_view kBlanks = " \t\r\n";

/// A folder that is removed with all that is in it.
class Folder {
 public:
  Folder() {
    std::error_code failure;
    std::string pattern = (std::filesystem::temp_directory_path(failure) / "segue-planner-XXXXXX").string();
    if (!failure && ::mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const path& get() const { return path_; }

 private:
  path path_;
};

std::string replaced(std::string text, std::string_view old, const std::string& with) {
  for (auto at = text.find(old); at != std::string::npos; at = text.find(old, at + with.size()))
    text.replace(at, old.size(), with);
  return text;
}

/// ": ..." with the last line of a text that is not empty.
std::string last_line(const std::string& text) {
  const std::string_view all = trimmed(text, kBlanks);
  const auto end = all.rfind('\n');
  const std::string_view line = trimmed(end == std::string_view::npos ? all : all.substr(end + 1), kBlanks);
  return line.empty() ? "" : "; the last that it wrote: " + quote(line);
}

/// A process group, which ends with this at the latest.
class Group {
 public:
  explicit Group(pid_t leader)
      : leader_(leader), descriptor_(static_cast<int>(::syscall(SYS_pidfd_open, leader, 0))) {}
  ~Group() { kill(); }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  /// False at the deadline.
  bool wait(Duration within) const {
    return descriptor_.valid() && wait_for_input(descriptor_.get(), within);
  }
  /// Ends all processes; how the leader has ended.
  int kill() {
    if (leader_ == 0) return status_;
    ::kill(-leader_, SIGKILL);
    ::waitpid(leader_, &status_, 0);
    leader_ = 0;
    return status_;
  }

 private:
  pid_t leader_;
  Descriptor descriptor_;
  int status_ = 0;
};

class Run {
 public:
  Run(const PlannerCommand& command, const std::stop_token& stop) : command_(command), stop_(stop) {}

  Result<std::string> run(std::string_view domain, std::string_view problem) {
    if (folder_.get().empty())
      return fail(ErrorCode::IoError, "cannot make a temporary folder for the planner");
    for (const auto& [name, text] : {std::pair("domain.pddl", domain), std::pair("problem.pddl", problem)}) {
      if (auto written = write_file(file(name), text); !written) return written.error();
    }
    const auto leader = start();
    if (!leader) return leader.error();
    Group group(*leader);
    const auto failure = wait(group);
    const int status = group.kill();
    output_ = read_file(file("output")).value_or("");
    errors_ = read_file(file("errors")).value_or("");
    if (failure) return *failure;
    return plan(status);
  }

 private:
  [[nodiscard]] path file(const char* name) const { return folder_.get() / name; }

  Result<pid_t> start() {
    std::vector<std::string> words = {"sh", "-c", with_limits(), "sh"};
    for (std::string word : command_.words) {
      word = replaced(std::move(word), "{domain}", file("domain.pddl").string());
      word = replaced(std::move(word), "{problem}", file("problem.pddl").string());
      words.push_back(replaced(std::move(word), "{plan}", file("plan").string()));
    }
    ChildProcess child(3);
    if (auto done = child.set_folder(folder_.get().string()); !done) return done.error();
    if (auto done = child.open_null(0); !done) return done.error();
    for (const auto& [name, number] : {std::pair("output", 1), std::pair("errors", 2)}) {
      const Descriptor opened(::open(file(name).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
      if (!opened.valid()) return system_error("cannot keep what the planner writes", errno);
      if (auto done = child.hand_over(opened.get(), number); !done) return done.error();
    }
    return child.start("/bin/sh", std::move(words));
  }

  /// Nothing of the planner must run without its limits, and they must not be those of this process.
  [[nodiscard]] std::string with_limits() const {
    constexpr int kBlock = 512;
    std::string script = "ulimit -f " + std::to_string(kLargestFile / kBlock);
    if (command_.memory > 0) script += " && ulimit -v " + std::to_string(command_.memory / 1024);
    return script + " && exec \"$@\"";
  }

  /// Until the planner has ended; the reason why it has to.
  std::optional<Error> wait(const Group& group) {
    constexpr Duration kLook = std::chrono::milliseconds(50);
    const TimePoint deadline = monotonic_now() + command_.timeout;
    while (!group.wait(std::clamp(deadline - monotonic_now(), Duration::zero(), kLook))) {
      if (stop_.stop_requested()) return fail(ErrorCode::Cancelled, "the planner was stopped");
      if (monotonic_now() >= deadline)
        return fail(ErrorCode::DeadlineExceeded,
                    "the planner found no plan within " + format_duration(command_.timeout));
    }
    return std::nullopt;
  }

  Result<std::string> plan(int status) {
    const std::string said = last_line(trimmed(errors_, kBlanks).empty() ? output_ : errors_);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ)
      return fail(ErrorCode::ResourceExhausted, "the planner wrote more than 64 MB into one file" + said);
    if (WIFSIGNALED(status))
      return fail(ErrorCode::IoError, "signal " + std::to_string(WTERMSIG(status)) + " (" +
                                          ::strsignal(WTERMSIG(status)) + ") ended the planner" + said);
    const std::string how = "the planner ended with status " + std::to_string(WEXITSTATUS(status));
    const bool writes = std::ranges::any_of(
        command_.words, [](const std::string& word) { return word.find("{plan}") != std::string::npos; });
    if (writes) {
      auto text = written_plan();
      if (text) return std::move(*text);
      return fail(ErrorCode::NotFound, how + " and without a plan" + said);
    }
    if (WEXITSTATUS(status) != 0) return fail(ErrorCode::NotFound, how + said);
    if (trimmed(output_, kBlanks).empty())
      return fail(ErrorCode::NotFound, how + " and printed no plan" + said);
    return std::move(output_);
  }

  [[nodiscard]] std::optional<std::string> written_plan() const {
    std::optional<std::string> last;
    if (auto text = read_file(file("plan"))) last = std::move(*text);
    for (int number = 1;; ++number) {
      auto text = read_file(file(("plan." + std::to_string(number)).c_str()));
      if (!text) return last;
      last = std::move(*text);
    }
  }

  const PlannerCommand& command_;
  const std::stop_token& stop_;
  Folder folder_;
  std::string output_;
  std::string errors_;
};

}  // namespace

Result<std::string> run_planner(const PlannerCommand& command, std::string_view domain,
                                std::string_view problem, const std::stop_token& stop) {
  if (command.words.empty() || command.words.front().empty())
    return fail(ErrorCode::InvalidArgument, "the planner's command is empty");
  return Run(command, stop).run(domain, problem);
}

}  // namespace segue::planner
