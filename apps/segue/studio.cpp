// SPDX-License-Identifier: Apache-2.0
#include <segue/web/page_files.hpp>
#include <segue/web/server.hpp>

#include <fmt/core.h>

#include <cstdint>
#include <memory>

#include "connection.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

constexpr std::uint32_t kDefaultPort = 8475;

struct StudioOptions {
  std::uint32_t port = kDefaultPort;
  std::string page;
  bool observe = false;
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

int serve_studio(const std::string& robot, const StudioOptions& options, const Context& context) {
  auto page = page_of(options);
  if (!page) return failed(context, page.error());
  StopSignal stop;
  const auto connect = [robot]() -> Result<std::unique_ptr<control::RobotService>> {
    const auto socket = control::socket_path(robot);
    if (!socket) return socket.error();
    return control::connect(*socket);
  };
  const web::ServerOptions serving = {.port = static_cast<std::uint16_t>(options.port),
                                      .role = options.observe ? web::Role::Observe : web::Role::Operate,
                                      .robot = robot,
                                      .entered = [&context](const std::string& address) {
                                        if (!context.json())
                                          print_line("a browser has come in; for another one:");
                                        print_address(address, context);
                                      }};
  const auto server = web::Server::start(std::move(*page), connect, serving);
  if (!server) return failed(context, server.error());
  if (!context.json())
    print_line(fmt::format(
        "the studio of robot {}{}; Ctrl-C ends it, the robot goes on. Open in one browser:", robot,
        options.observe ? " (observe only)" : ""));
  print_address((*server)->address(), context);
  stop.wait(std::nullopt);
  return kDone;
}

}  // namespace

void add_studio(Verb& app, Context& context) {
  const auto options = std::make_shared<StudioOptions>();
  Verb& verb = add_verb(
      app, context, "studio", "watch and operate a running robot in a browser",
      "  segue studio\n  segue studio --observe    # who opens the page can look, not change\n"
      "  segue studio --robot rover --port 0\n\n"
      "The page is served to browsers of this computer only, and to those that open the address that\n"
      "is printed, each of which opens the page once.",
      [options, &context] {
        const auto [robot, status] = reach(context);
        return robot ? serve_studio(context.robot, *options, context) : status;
      });
  verb.option("--port PORT", options->port, "where it listens on 127.0.0.1 (default 8475; 0: any free port)")
      .between(std::size_t{0}, std::size_t{65535});
  verb.option("--page FOLDER", options->page,
              "the built page (default: the one that is installed with segue)");
  verb.flag("--observe", options->observe, "browsers may look but not change anything");
  add_robot_option(verb, context);
}

}  // namespace segue::cli
