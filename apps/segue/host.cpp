// SPDX-License-Identifier: Apache-2.0
#include <segue/control/server.hpp>
#include <segue/process/process_server.hpp>

#include <fmt/core.h>
#include <unistd.h>

#include <memory>

#include "command.hpp"
#include "output.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

struct HostOptions {
  std::vector<std::string> zygote;
};

int run_host(const HostOptions& options, const Context& context) {
  StopSignal stop;
  const auto folder = control::socket_folder();
  if (!folder) return failed(context, folder.error());
  process::ProcessServerOptions chosen;
  chosen.zygote = true;
  chosen.zygote_libraries = options.zygote;
  const auto processes = process::ProcessServer::create(chosen);
  if (!processes) return failed(context, processes.error());
  const auto socket = *folder / "host.sock";
  const auto server = control::Server::listen(socket, processes->get());
  if (!server) return failed(context, server.error());
  if (context.json()) {
    print_json_line(type::Value::map({{"socket", socket.string()}, {"pid", static_cast<int>(::getpid())}}));
  } else {
    print_line(fmt::format("the process server is running (pid {}) at {}; Ctrl-C ends it", ::getpid(),
                           socket.string()));
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
  verb.option(
      "--zygote LIBRARY", options->zygote,
      "load this component library once for all deployments, so that they start faster; may be repeated");
  add_host_certificates(verb, context);
}

}  // namespace segue::cli
