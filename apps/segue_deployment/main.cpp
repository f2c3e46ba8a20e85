// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/deployment_exit.hpp>
#include <segue/deploy/zygote.hpp>
#include <segue/deploy/zygote_message.hpp>

#include <cstdio>
#include <exception>
#include <string_view>

#include "deployment_process.hpp"

namespace {

int run(int count, char** arguments) {
  using segue::deploy::detail::run_zygote;
  if (count > 2 && arguments[1] == segue::deploy::detail::kZygoteOption) {
    return run_zygote({count, arguments}, &segue::deployment_process);
  }
  return segue::deployment_process();
}

}  // namespace

int main(int count, char** arguments) {
  const bool alone = count != 2 || std::string_view(arguments[1]).starts_with('-');
  if (alone && (count < 3 || arguments[1] != segue::deploy::detail::kZygoteOption)) {
    std::fputs("segue-deployment is started by a process server (`segue run`, `segue host`), never by hand\n",
               stderr);
    return segue::deploy::kWrongUse;
  }
  try {
    return run(count, arguments);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "error: segue-deployment: %s\n", exception.what());
    return segue::deploy::kDefect;
  }
}
