// SPDX-License-Identifier: Apache-2.0
#include <segue/control/deployment_client.hpp>
#include <segue/control/server.hpp>
#include <segue/hosts/local_host.hpp>
#include <segue/process/process_hub.hpp>
#include <segue/process/process_server.hpp>

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "command.hpp"
#include "output.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

struct HostOptions {
  std::vector<std::string> zygote;
  std::string name;
  std::string state;
};

/// The name of this computer without its domain.
std::string computer_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "host";
  const std::string whole(name.data());
  return whole.substr(0, whole.find('.'));
}

/// Where the daemon keeps what outlives it: /var/lib/segue for root, else $XDG_STATE_HOME/segue.
std::filesystem::path state_folder() {
  if (::geteuid() == 0) return "/var/lib/segue";
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state == '/') {
    return std::filesystem::path(state) / "segue";
  }
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home == nullptr ? "/tmp" : home) / ".local" / "state" / "segue";
}

int run_host(const HostOptions& options, const Context& context) {
  StopSignal stop;
  const auto folder = control::socket_folder();
  if (!folder) return failed(context, folder.error());
  process::ProcessServerOptions chosen;
  chosen.zygote = true;
  chosen.zygote_libraries = options.zygote;
  const auto processes = process::ProcessServer::create(chosen);
  if (!processes) return failed(context, processes.error());
  process::ProcessHub hub(**processes);
  const auto shared = hub.for_all();
  const auto watched = hub.for_all();
  const auto state = options.state.empty() ? state_folder() : std::filesystem::path(options.state);
  std::error_code ignored;
  std::filesystem::create_directories(state.parent_path(), ignored);  // LocalHost says what is wrong
  const std::string name = options.name.empty() ? computer_name() : options.name;
  const auto host =
      hosts::LocalHost::create(*watched, &control::connect_deployment, {model::HostName(name), state});
  if (!host) return failed(context, host.error());
  const auto socket = *folder / "host.sock";
  const auto server = control::Server::listen(socket, shared.get());
  if (!server) return failed(context, server.error());
  const auto daemon_socket = control::daemon_socket();
  if (!daemon_socket) return failed(context, daemon_socket.error());
  const auto daemon = control::Server::listen(*daemon_socket, host->get());
  if (!daemon) return failed(context, daemon.error());
  if (context.json()) {
    print_json_line(type::Value::map({{"name", name},
                                      {"socket", socket.string()},
                                      {"daemon", daemon_socket->string()},
                                      {"pid", static_cast<int>(::getpid())}}));
  } else {
    print_line(fmt::format("host {} is running (pid {}) at {}; Ctrl-C ends it", name, ::getpid(),
                           daemon_socket->string()));
  }
  const auto reason = stop.wait({});
  if (!context.json()) {
    print_line(fmt::format("{}; deployments keep running and will be found again", reason.value_or("ended")));
  }
  return kDone;
}

}  // namespace

void add_host(Verb& app, Context& context) {
  const auto options = std::make_shared<HostOptions>();
  Verb& verb = add_verb(app, context, "host",
                        "run the process server of this computer as a daemon, or keep certificates",
                        "  segue host\n  segue host --zygote segue_components_demo",
                        [options, &context] { return run_host(*options, context); });
  verb.option("--name NAME", options->name, "what robot files call this computer; default: its host name");
  verb.option("--state FOLDER", options->state,
              "where to keep what outlives the daemon; default: /var/lib/segue for root, else "
              "$XDG_STATE_HOME/segue");
  verb.option(
      "--zygote LIBRARY", options->zygote,
      "load this component library once for all deployments, so that they start faster; may be repeated");
  add_host_certificates(verb, context);
}

}  // namespace segue::cli
