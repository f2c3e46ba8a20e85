// SPDX-License-Identifier: Apache-2.0
// The overhead of a call to a deployment process. Baseline: a byte there and back over a bare Unix socket.
#include <segue/control/deployment_client.hpp>
#include <segue/control/server.hpp>

#include "support/measure.hpp"

#include <support/fake_deployment.hpp>

#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace bench;
using namespace segue;
using control::action_of;

constexpr std::size_t kRepeats = 3000;
constexpr std::size_t kBatch = 25;

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(1);
}

/// Runs `serve` in a process of its own, which ends with this one.
template <class Serve>
void start_process(Serve serve) {
  const pid_t pid = ::fork();
  if (pid < 0) give_up("cannot fork");
  if (pid > 0) return;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  serve();
  std::exit(0);
}

Summary bare_ping_pong() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) give_up("no sockets");
  start_process([&] {
    char byte = 0;
    while (::read(ends[1], &byte, 1) == 1 && ::write(ends[1], &byte, 1) == 1) {
    }
  });
  ::close(ends[1]);
  const auto summary = measure(kRepeats, [&] {
    char byte = 1;
    if (::write(ends[0], &byte, 1) != 1 || ::read(ends[0], &byte, 1) != 1) give_up("the other end is gone");
  });
  ::close(ends[0]);
  return summary;
}

deploy::Snapshot snapshot_of(std::size_t tasks) {
  deploy::Snapshot snapshot;
  for (std::size_t i = 0; i < tasks; ++i) {
    const std::string id = "task" + std::to_string(i);
    model::Task task;
    task.id = model::TaskId(id);
    snapshot.network.tasks.push_back(std::move(task));
    task_host::TaskReport report;
    report.id = model::TaskId(id);
    snapshot.tasks.push_back(std::move(report));
  }
  return snapshot;
}

std::vector<model::Action> batch_of(model::ActionKind kind, std::size_t size) {
  std::vector<model::Action> actions;
  for (std::size_t i = 0; i < size; ++i) {
    const std::string id = "task" + std::to_string(i);
    actions.push_back(action_of(kind, id));
    if (kind == model::ActionKind::Connect) {
      actions.back().what =
          model::ConnectionAction{{{model::TaskId(id), "out"}, {model::TaskId("next"), "in"}, {}, {}}};
    }
  }
  return actions;
}

void calls(const std::filesystem::path& socket, Duration floor) {
  auto process = control::connect_deployment(socket, control::soon(), nullptr);
  while (!process && process.error().code == ErrorCode::Unavailable)
    process = control::connect_deployment(socket, control::soon(), nullptr);
  if (!process) give_up(to_string(process.error()));
  auto& service = *process->service;
  Table table("Calls of a deployment process, compared with a byte there and back");
  const auto perform = [&](const std::vector<model::Action>& actions) {
    return measure(kRepeats, [&] {
      for (const auto& outcome : service.perform_all(actions, control::soon()))
        if (!outcome) give_up(to_string(outcome.error()));
    });
  };
  table.add("info", measure(kRepeats, [&] { keep(service.info()); }), 1, floor);
  table.add("snapshot of 25 tasks", measure(kRepeats, [&] { keep(service.snapshot()); }), 1, floor);
  const auto one = perform(batch_of(model::ActionKind::Start, 1));
  const auto starts = perform(batch_of(model::ActionKind::Start, kBatch));
  const auto connects = perform(batch_of(model::ActionKind::Connect, kBatch));
  table.add("perform 1 start", one, 1, floor);
  table.add("perform 25 starts", starts, 1, floor);
  table.add("perform 25 starts, each", starts, kBatch);
  table.add("perform 25 connects, each", connects, kBatch);
  table.print();
}

}  // namespace

int main() {
  const auto floor = bare_ping_pong();
  Table table("Floor");
  table.add("a byte there and back between two processes", floor);
  table.print();

  const auto socket =
      std::filesystem::temp_directory_path() / ("segue-bench-" + std::to_string(::getpid()) + ".sock");
  start_process([&] {
    control::FakeDeployment deployment;
    deployment.now = snapshot_of(kBatch);
    const auto server = control::Server::listen(socket, &deployment);
    if (!server) give_up(to_string(server.error()));
    ::pause();
  });
  calls(socket, floor.median);
  std::filesystem::remove(socket);
  std::filesystem::remove(std::filesystem::path(socket) += ".lock");
  return 0;
}
