// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>
#include <segue/base/system_error.hpp>
#include <segue/base/text.hpp>
#include <segue/deploy/assignment.hpp>
#include <segue/deploy/spawn.hpp>

#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string_view>

namespace segue::deploy::detail {

namespace {

namespace fs = std::filesystem;

constexpr const char* kProgramName = "segue-deployment";

/// posix_spawn_file_actions_t as a value. Sources are first moved out of the way of the numbers that they
/// will have, so that none is overwritten before its turn.
class FileActions {
 public:
  FileActions() { ::posix_spawn_file_actions_init(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  ~FileActions() { ::posix_spawn_file_actions_destroy(&actions_); }

  Result<void> hand_over(int source, int number) {
    Descriptor moved(::fcntl(source, F_DUPFD_CLOEXEC, static_cast<int>(kFirstFree)));
    if (!moved.valid()) return system_error("cannot hand a descriptor to a process", errno);
    return put(std::move(moved), number);
  }
  Result<void> open_null(int number) {
    Descriptor null(::open("/dev/null", O_RDWR | O_CLOEXEC));
    if (!null.valid()) return system_error("cannot open /dev/null", errno);
    return hand_over(null.get(), number);
  }
  void close_others() { ::posix_spawn_file_actions_addclosefrom_np(&actions_, kFirstFree); }
  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  Result<void> put(Descriptor moved, int number) {
    const int reason = ::posix_spawn_file_actions_adddup2(&actions_, moved.get(), number);
    moved_.push_back(std::move(moved));
    if (reason != 0) return system_error("cannot hand a descriptor to a process", reason);
    return {};
  }

  posix_spawn_file_actions_t actions_{};
  std::vector<Descriptor> moved_;
};

/// posix_spawnattr_t as a value: a group of its own, clean signals.
class Attributes {
 public:
  Attributes() {
    ::posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigset_t all;
    ::sigemptyset(&none);
    ::sigfillset(&all);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setsigdefault(&attributes_, &all);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_,
                               POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  ~Attributes() { ::posix_spawnattr_destroy(&attributes_); }
  [[nodiscard]] const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

/// "NAME=value" of this process and then `more`, which goes before.
std::vector<std::string> merged_environment(const std::vector<std::pair<std::string, std::string>>& more) {
  std::vector<std::string> result;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    const auto name = text.substr(0, text.find('='));
    if (std::ranges::find(more, name, [](const auto& each) { return std::string_view(each.first); }) ==
        more.end()) {
      result.emplace_back(text);
    }
  }
  for (const auto& [name, value] : more)
    result.push_back(name + '=' + value);
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size() + 1);
  for (std::string& text : texts)
    result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

Result<void> describe(FileActions& actions, const HandedOver& files) {
  if (auto done = actions.open_null(STDIN_FILENO); !done) return done;
  for (const int number : {STDOUT_FILENO, STDERR_FILENO}) {
    auto done = files.output < 0 ? actions.open_null(number) : actions.hand_over(files.output, number);
    if (!done) return done;
  }
  const std::pair<int, int> handed[] = {
      {files.assignment, kAssignment}, {files.listener, kListener}, {files.lock, kLock}};
  for (const auto& [source, number] : handed) {
    if (source < 0) continue;
    if (auto done = actions.hand_over(source, number); !done) return done;
  }
  actions.close_others();
  return {};
}

bool can_run(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
}

std::vector<fs::path> folders_of_path() {
  const char* variable = std::getenv("PATH");
  std::string_view rest = variable == nullptr ? "" : variable;
  std::vector<fs::path> folders;
  while (!rest.empty()) {
    const auto colon = std::min(rest.find(':'), rest.size());
    if (colon > 0) folders.emplace_back(rest.substr(0, colon));
    rest.remove_prefix(std::min(colon + 1, rest.size()));
  }
  return folders;
}

std::vector<fs::path> program_folders() {
  std::vector<fs::path> folders;
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) folders.push_back(self.parent_path());
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&program_folders), &info) != 0 && info.dli_fname != nullptr) {
    // <prefix>/lib, or <prefix>/lib/<architecture>
    const fs::path own = fs::absolute(info.dli_fname, failed).parent_path();
    folders.push_back(own.parent_path() / "bin");
    folders.push_back(own.parent_path().parent_path() / "bin");
  }
  for (fs::path& folder : folders_of_path())
    folders.push_back(std::move(folder));
  return folders;
}

Result<fs::path> runnable(const fs::path& program, const char* origin) {
  if (can_run(program)) return program;
  return fail(ErrorCode::NotFound, quote(program.native()) + " (" + origin + ") is no program that can run");
}

}  // namespace

Result<pid_t> spawn(const fs::path& program, const std::vector<std::string>& arguments,
                    const std::vector<std::pair<std::string, std::string>>& environment,
                    const HandedOver& files) {
  FileActions actions;
  if (auto described = describe(actions, files); !described) return std::move(described.error());
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), kProgramName);
  std::vector<std::string> variables = merged_environment(environment);
  const Attributes attributes;
  pid_t pid = 0;
  const int reason = ::posix_spawn(&pid, program.c_str(), actions.get(), attributes.get(),
                                   pointers(words).data(), pointers(variables).data());
  if (reason != 0) return system_error("cannot start " + quote(program.native()), reason);
  return pid;
}

Result<fs::path> find_program(const fs::path& chosen) {
  if (!chosen.empty()) return runnable(chosen, "as chosen");
  const char* variable = std::getenv("SEGUE_DEPLOYMENT");
  if (variable != nullptr && *variable != '\0') return runnable(variable, "$SEGUE_DEPLOYMENT");
  for (const fs::path& folder : program_folders()) {
    if (can_run(folder / kProgramName)) return folder / kProgramName;
  }
  return fail(ErrorCode::NotFound,
              "the program segue-deployment is neither beside this program nor in the install prefix nor in "
              "PATH; set SEGUE_DEPLOYMENT to it");
}

}  // namespace segue::deploy::detail
