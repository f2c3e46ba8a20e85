// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/deployment_exit.hpp>

#include <cstdio>
#include <exception>
#include <string_view>

#include "deployment_process.hpp"

int main(int count, char** arguments) {
  if (count != 2 || std::string_view(arguments[1]).starts_with('-')) {
    std::fputs("segue-deployment is started by a process server (`segue run`, `segue host`), never by hand\n",
               stderr);
    return segue::deploy::kWrongUse;
  }
  try {
    return segue::deployment_process();
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "error: segue-deployment: %s\n", exception.what());
    return segue::deploy::kDefect;
  }
}
