// SPDX-License-Identifier: Apache-2.0
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/control/deployment_client.hpp>
#include <segue/control/server.hpp>
#include <segue/distributed/local_host.hpp>
#include <segue/model/host_config.hpp>
#include <segue/process_server/process_hub.hpp>
#include <segue/process_server/process_server.hpp>
#include <segue/rpc/credentials.hpp>
#include <segue/rpc_tls/credential_files.hpp>

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>

#include "../command.hpp"
#include "../models.hpp"
#include "../output.hpp"
#include "../stop_signal.hpp"

namespace segue::cli {

namespace {

struct HostOptions {
  std::string config;
  std::string listen;
  std::string credentials;
  std::vector<std::string> zygote;
  std::string name;
  std::string state;
  bool until_eof = false;
  LogLevel log_level = LogLevel::Info;
};

/// The port of daemons unless one is given.
constexpr std::uint16_t kPort = 7447;

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
  if (const char* given = std::getenv("XDG_STATE_HOME"); given != nullptr && *given == '/')
    return std::filesystem::path(given) / "segue";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home == nullptr ? "/tmp" : home) / ".local/state/segue";
}

/// The configuration file that is read without --config, if it is there.
std::filesystem::path usual_config() {
  const auto folder = configuration_folder();
  return folder ? *folder / "host.yaml" : std::filesystem::path();
}

/// The file, then the command line, which wins, then the defaults.
std::optional<model::HostConfig> configuration(const HostOptions& options, Diagnostics& diagnostics) {
  model::HostConfig config;
  std::error_code none;
  const std::filesystem::path file =
      options.config.empty() ? usual_config() : std::filesystem::path(options.config);
  if (!options.config.empty() || std::filesystem::exists(file, none)) {
    auto read = model::load_host_config(std::filesystem::absolute(file), diagnostics);
    if (!read) return std::nullopt;
    config = std::move(*read);
  }
  if (!options.name.empty()) config.name = options.name;
  if (!options.listen.empty()) config.listen = options.listen;
  if (!options.credentials.empty()) config.credentials = options.credentials;
  if (!options.state.empty()) config.state = options.state;
  if (!options.zygote.empty()) config.zygote = options.zygote;
  if (config.name.empty()) config.name = computer_name();
  if (config.state.empty()) config.state = state_folder();
  return config;
}

/// Where the daemon listens on the network; nothing unless it is told to.
Result<std::optional<control::TcpPlace>> tcp_place(const model::HostConfig& config) {
  if (config.listen.empty()) return std::optional<control::TcpPlace>();
  auto address = control::parse_tcp_address(config.listen, kPort);
  if (!address) return address.error();
  const auto folder = config.credentials.empty() ? control::credentials_folder()
                                                 : Result<std::filesystem::path>(config.credentials);
  if (!folder) return folder.error();
  auto credentials = control::load_credentials(*folder, control::CertificateUse::Host, config.name);
  if (!credentials) return credentials.error();
  return std::optional(control::TcpPlace{std::move(*address), std::move(*credentials)});
}

/// Prints the daemon's name and addresses once it serves.
void announce(const model::HostConfig& config, const std::filesystem::path& socket, std::uint16_t port,
              const Context& context) {
  const int pid = ::getpid();
  if (context.json()) {
    return print_json_line(
        type::Value::map({{"name", config.name}, {"socket", socket.string()}, {"port", port}, {"pid", pid}}));
  }
  const std::string network = port == 0 ? std::string() : fmt::format(" and port {}", port);
  print_line(fmt::format("host {} is running (pid {}) at {}{}; Ctrl-C ends it", config.name, pid,
                         socket.string(), network));
}

/// Runs the daemon. Returns why it has ended, when nobody can ask it for anything any more.
Result<std::string> serve_host(const model::HostConfig& config, process_server::ProcessService& processes,
                               StopSignal& stop, const Context& context) {
  const auto folder = control::socket_folder();
  if (!folder) return folder.error();
  process_server::ProcessHub hub(processes);
  const auto for_runtimes = hub.for_all();
  const auto for_host = hub.for_all();
  std::error_code ignored;
  std::filesystem::create_directories(config.state.parent_path(), ignored);  // LocalHost says what is wrong
  const auto host = distributed::LocalHost::create(*for_host, &control::connect_deployment,
                                                   {model::HostName(config.name), config.state});
  if (!host) return host.error();
  auto tcp = tcp_place(config);
  if (!tcp) return tcp.error();
  const auto socket = control::daemon_socket();
  if (!socket) return socket.error();
  const auto process_server = control::Server::listen(*folder / "host.sock", for_runtimes.get());
  if (!process_server) return process_server.error();
  const auto daemon = control::Server::listen(control::Places{*socket, std::move(*tcp)}, host->get());
  if (!daemon) return daemon.error();
  announce(config, *socket, (*daemon)->port(), context);
  return stop.wait({}).value_or("ended");
}

/// Kills the deployments of all robots here: each robot has a folder for their sockets.
void kill_deployments(process_server::ProcessService& processes) {
  constexpr auto kPatience = std::chrono::seconds(10);
  const auto folder = control::socket_folder();
  if (!folder) return;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(*folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    if (!entry->is_directory()) continue;
    const auto running = processes.processes(entry->path().filename().string());
    if (!running) continue;
    for (const auto& process : *running)
      (void)processes.kill(process.robot, process.key, RealClock::instance().now() + kPatience);
  }
}

int run_host(const HostOptions& options, const Context& context) {
  set_log_level(options.log_level);
  StopSignal stop(options.until_eof ? STDIN_FILENO : -1);
  Diagnostics diagnostics;
  const auto config = configuration(options, diagnostics);
  if (!config) return report_failure(context, diagnostics);
  process_server::ProcessServerOptions chosen;
  chosen.zygote = true;
  chosen.zygote_libraries = config->zygote;
  const auto processes = process_server::ProcessServer::create(chosen);
  if (!processes) return failed(context, processes.error());
  const auto reason = serve_host(*config, **processes, stop, context);
  if (options.until_eof) kill_deployments(**processes);
  if (!reason) return failed(context, reason.error());
  if (!context.json() && !options.until_eof)
    print_line(fmt::format("{}; deployments keep running and will be found again", *reason));
  return kDone;
}

}  // namespace

void add_host(Verb& app, Context& context) {
  const auto options = std::make_shared<HostOptions>();
  Verb& verb = add_verb(app, context, "host",
                        "run the process server of this computer as a daemon, or keep certificates",
                        "  segue host\n  segue host --zygote segue_components_demo\n"
                        "  segue host --listen 0.0.0.0          # for other computers, by certificates\n"
                        "  segue host list robot.yaml",
                        [options, &context] { return run_host(*options, context); });
  verb.option("--config FILE", options->config,
              "the configuration file; default, if it is there: $XDG_CONFIG_HOME/segue/host.yaml, "
              "~/.config/segue/host.yaml or, for root, /etc/segue/host.yaml");
  verb.option("--listen ADDRESS", options->listen,
              "also serve other computers, at this address and port (default 7447); needs certificates");
  verb.option("--credentials FOLDER", options->credentials,
              "the folder with this host's certificate; default: that of `segue host init`");
  verb.option("--name NAME", options->name, "what robot files call this computer; default: its host name");
  verb.option("--state FOLDER", options->state,
              "where to keep what outlives the daemon; default: /var/lib/segue for root, else "
              "$XDG_STATE_HOME/segue");
  add_log_level_option(verb, options->log_level, "messages shown");
  verb.flag("--until-eof", options->until_eof,
            "end when standard input ends, and kill all deployments here at the end: for programs that need "
            "a host for a while");
  verb.option(
      "--zygote LIBRARY", options->zygote,
      "load this component library once for all deployments, so that they start faster; may be repeated");
  add_host_list(verb, context);
  add_host_certificates(verb, context);
}

}  // namespace segue::cli
