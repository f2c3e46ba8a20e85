// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/rpc/credentials.hpp>
#include <segue/rpc_tls/credential_files.hpp>
#include <segue/web/page_files.hpp>
#include <segue/web/web_server.hpp>

#include <fmt/core.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>

#include "../connection.hpp"
#include "../models.hpp"
#include "../output.hpp"
#include "../ros2/ros2_look.hpp"
#include "../stop_signal.hpp"
#include "studio_missions.hpp"
#include "studio_process.hpp"
#include "studio_ros2.hpp"

namespace segue::cli {

namespace {

struct StudioOptions {
  std::uint32_t port = kStudioPort;
  std::string listen;  ///< empty: for this computer only
  std::string credentials;
  std::string name;
  std::string page;
  bool observe = false;
  bool until_eof = false;
};

void print_address(const std::string& address, const Context& context) {
  if (context.json()) {
    print_json_line(type::Value::map({{"address", address}}));
  } else {
    print_line(address);
  }
}

Result<web::PageFiles> page_of(const StudioOptions& options) {
  if (!options.page.empty()) return web::PageFiles::read(options.page);
  const auto folder = web::PageFiles::installed();
  if (!folder) return folder.error();
  return web::PageFiles::read(*folder);
}

/// The credentials of this host, if other computers may connect.
Result<std::optional<control::Credentials>> credentials_of(const StudioOptions& options) {
  if (options.listen.empty()) return std::optional<control::Credentials>();
  const auto folder = options.credentials.empty() ? control::credentials_folder()
                                                  : Result<std::filesystem::path>(options.credentials);
  if (!folder) return folder.error();
  auto loaded = control::load_credentials(*folder, control::CertificateUse::Host, options.name);
  if (!loaded) return loaded.error();
  return std::optional(std::move(*loaded));
}

std::string introduction(const std::string& robot, const StudioOptions& options, bool secure) {
  return fmt::format(
      "the studio of robot {}{}{}. {}", robot, options.observe ? " (observe only)" : "",
      options.until_eof ? "" : "; Ctrl-C ends it and missions that it has started, the robot goes on",
      secure ? "Open it in browsers that have the certificate of a person:" : "Open in one browser:");
}

model::ComponentCatalog models_for_editing(const model::Robot& robot, Diagnostics& diagnostics) {
  model::ComponentCatalog catalog = load_catalog({}, diagnostics);
  add_robot_models(robot, catalog, diagnostics);
  model::resolve_inheritance(catalog, diagnostics);
  return catalog;
}

int serve_studio(const std::string& robot, const StudioOptions& options, const Context& context) {
  auto page = page_of(options);
  if (!page) return failed(context, page.error());
  StopSignal stop(options.until_eof ? STDIN_FILENO : -1);
  const auto connect = [robot] { return connect_to(robot); };
  const auto credentials = credentials_of(options);
  if (!credentials) return failed(context, credentials.error());
  StudioMissions missions(robot);
  std::stop_source end;
  const web::ServerOptions serving = {
      .port = static_cast<std::uint16_t>(options.port),
      .listen = options.listen.empty() ? "127.0.0.1" : options.listen,
      .credentials = *credentials,
      .role = options.observe ? control::Role::Observe : control::Role::Administer,
      .robot = robot,
      .models = models_for_editing,
      .run_mission = [&missions](const web::MissionOrder& order,
                                 TimePoint deadline) { return missions.run(order, deadline); },
      .look_at_ros2 = [stop = end.get_token()](
                          const web::Ros2Place& place,
                          TimePoint deadline) { return look_for_pages(place, Wait(deadline, stop)); },
      .has_ros2 = can_look_at_ros2() && is_ros2_used(),
      .entered =
          [&context](const std::string& address) {
            if (!context.json()) print_line("browser connected; to open another:");
            print_address(address, context);
          }};
  const auto server = web::Server::start(std::move(*page), connect, serving);
  if (!server) return failed(context, server.error());
  if (!context.json()) print_line(introduction(robot, options, credentials->has_value()));
  print_address((*server)->address(), context);
  stop.wait(std::nullopt);
  end.request_stop();
  if (missions.running() > 0) print_note("the mission that was started here ends, too");
  missions.end();
  return kDone;
}

}  // namespace

void add_studio(Verb& app, Context& context) {
  const auto options = std::make_shared<StudioOptions>();
  Verb& verb = add_verb(
      app, context, "studio", "watch and operate a running robot in a browser",
      "  segue studio\n  segue studio --observe    # who opens the page can look, not change\n"
      "  segue studio --robot rover --port 0\n"
      "  segue studio --listen 0.0.0.0             # for browsers of other computers, with certificates\n\n"
      "Without --listen, the page is served to browsers of this computer only, and to those that open the\n"
      "address that is printed, each of which opens the page once. With it, connections are encrypted and\n"
      "browsers show the certificate of a person (`segue host enrol`), whose role says what they may do.",
      [options, &context] {
        const auto [robot, status] = reach(context);
        return robot ? serve_studio(context.robot, *options, context) : status;
      });
  const Option listen =
      verb.option("--listen ADDRESS", options->listen,
                  "an IP address of this computer, or 0.0.0.0 for all: for browsers of other computers, with "
                  "certificates");
  verb.option("--credentials FOLDER", options->credentials,
              "with --listen: the folder with this computer's certificate; otherwise as of `segue host`")
      .needs(listen);
  verb.option("--name NAME", options->name, "with --listen: which certificate, where there are several")
      .needs(listen);
  verb.option("--port PORT", options->port, "where it listens (default 8475; 0: any free port)")
      .between(std::size_t{0}, std::size_t{65535});
  verb.option("--page FOLDER", options->page,
              "the built page (default: the one that is installed with segue)");
  verb.flag("--observe", options->observe, "browsers may look but not change anything");
  verb.flag("--until-eof", options->until_eof,
            "end when standard input ends, too: for programs that start a studio");
  add_robot_option(verb, context);
}

}  // namespace segue::cli
