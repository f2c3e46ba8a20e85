// SPDX-License-Identifier: Apache-2.0
#include <segue/base/printable.hpp>
#include <segue/base/time_slice.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/zygote.hpp>
#include <segue/process_server/zygote_message.hpp>
#include <segue/task_host/component_library.hpp>

#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "deployment_process.hpp"

namespace {

int run(int count, char** arguments) {
  using segue::process_server::detail::run_zygote;
  if (count > 2 && arguments[1] == segue::process_server::detail::kZygoteOption) {
    segue::task_host::LibrarySet libraries;
    segue::PreparedProcess prepared;
    return run_zygote({count, arguments},
                      {[&](const std::string& library) { return libraries.load(library); },
                       [&] { prepared = segue::prepare_deployment_process(); },
                       [&] { return segue::deployment_process(std::move(prepared)); }});
  }
  return segue::deployment_process({});
}

}  // namespace

int main(int count, char** arguments) {
  const bool alone = count != 2 || std::string_view(arguments[1]).starts_with('-');
  if (alone && (count < 3 || arguments[1] != segue::process_server::detail::kZygoteOption)) {
    std::fputs("segue-deployment is started by a process server (`segue run`, `segue host`), not by hand\n",
               stderr);
    return segue::process_server::kWrongUse;
  }
  segue::ask_for_short_time_slices();
  try {
    return run(count, arguments);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "error: segue-deployment: %s\n", segue::printable(exception.what()).c_str());
    return segue::process_server::kDefect;
  }
}
