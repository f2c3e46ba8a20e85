// SPDX-License-Identifier: Apache-2.0
#include <segue/base/child_process.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/spawn.hpp>

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace segue::process_server::detail {

namespace {

namespace fs = std::filesystem;

Result<void> describe(ChildProcess& child, const HandedOver& files) {
  if (auto done = child.open_null(STDIN_FILENO); !done) return done;
  for (const int number : {STDOUT_FILENO, STDERR_FILENO}) {
    auto done = files.output < 0 ? child.open_null(number) : child.hand_over(files.output, number);
    if (!done) return done;
  }
  const std::pair<int, int> handed[] = {{files.assignment, kAssignment},
                                        {files.listener, kListener},
                                        {files.lock, kLock},
                                        {files.output_changes, kOutputChanges}};
  for (const auto& [source, number] : handed) {
    if (source < 0) continue;
    if (auto done = child.hand_over(source, number); !done) return done;
  }
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

/// The folder of this program comes first, so that tests and tools use the program of their own build.
std::vector<fs::path> program_folders() {
  std::vector<fs::path> folders;
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) folders.push_back(self.parent_path());
  for (const fs::path& prefix : install_prefixes())
    folders.push_back(prefix / "bin");
  for (fs::path& folder : folders_of_path())
    folders.push_back(std::move(folder));
  return folders;
}

Result<fs::path> runnable(const fs::path& program, const char* origin) {
  if (can_run(program)) return program;
  return fail(ErrorCode::NotFound, quote(program.native()) + " (" + origin + ") is not an executable file");
}

}  // namespace

Result<pid_t> spawn(const fs::path& program, const std::vector<std::string>& arguments,
                    const std::vector<std::pair<std::string, std::string>>& environment,
                    const HandedOver& files) {
  ChildProcess child(kFirstFree);
  if (auto described = describe(child, files); !described) return std::move(described.error());
  child.set_environment(environment);
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), kDeploymentProgram);
  return child.start(program.native(), std::move(words));
}

Result<fs::path> find_program(const fs::path& chosen) {
  if (!chosen.empty()) return runnable(chosen, "as chosen");
  const char* variable = std::getenv("SEGUE_DEPLOYMENT");
  if (variable != nullptr && *variable != '\0') return runnable(variable, "$SEGUE_DEPLOYMENT");
  for (const fs::path& folder : program_folders()) {
    if (can_run(folder / kDeploymentProgram)) return folder / kDeploymentProgram;
  }
  return fail(ErrorCode::NotFound,
              "the program segue-deployment is neither beside this program nor in the install prefix nor in "
              "PATH; set SEGUE_DEPLOYMENT to it");
}

}  // namespace segue::process_server::detail
