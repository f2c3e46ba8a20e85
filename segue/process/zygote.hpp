// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/process/process_service.hpp>
#include <segue/process/spawn.hpp>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// A process with one thread that has the component libraries loaded and relocated already, and becomes
/// deployment processes by fork: a few milliseconds quicker for each than a program that starts from nothing.
namespace segue::process::detail {

/// The zygote of a process server. Functions may be called from any thread. What fails with Unavailable does
/// so for ever: the zygote is gone; its children go on.
class Zygote {
 public:
  /// Starts `program --zygote LIBRARY...`; what it prints goes to `log`. Answers before it is ready.
  static Result<std::unique_ptr<Zygote>> start(const std::filesystem::path& program,
                                               const std::vector<std::string>& libraries,
                                               const std::filesystem::path& log);
  /// Tells it to go; its children go on.
  ~Zygote();
  Zygote(const Zygote&) = delete;
  Zygote& operator=(const Zygote&) = delete;

  /// A new deployment process, as spawn() makes them. It is not reaped before reap().
  Result<pid_t> launch(const std::string& title, const HandedOver& files);
  /// The exit status of a child that has ended. Not known where the zygote is gone.
  ExitReason reap(int pid);

 private:
  struct Request;
  struct Reply;
  Zygote(Descriptor socket, int pid) : socket_(std::move(socket)), pid_(pid) {}
  std::optional<Reply> ask(const Request& request, std::span<const int> descriptors);
  void end();

  std::mutex mutex_;
  Descriptor socket_;  ///< not valid: gone
  int pid_;
};

/// The command line of this process, which is to be changed.
struct CommandLine {
  int count = 0;
  char** words = nullptr;
};

/// Loads a component library by its name, in the zygote.
using Preload = std::function<Result<void>(const std::string& library)>;

/// The zygote's side: preloads the libraries that its command line names, then forks deployment processes
/// until its server is gone. In a child it answers what `deployment_process` does. Must begin with one
/// thread.
int run_zygote(CommandLine command, const Preload& preload, const std::function<int()>& deployment_process);

}  // namespace segue::process::detail
