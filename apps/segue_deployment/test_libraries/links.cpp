// SPDX-License-Identifier: Apache-2.0
#include <segue/task/component.hpp>
#include <segue/task_host/component_library.hpp>

#include <dlfcn.h>

#include <cstdio>
#include <filesystem>

namespace links {

/// Needs a folder that the program of a deployment contains, and says whose code it got.
class Component final : public segue::task::Component {
 public:
  Component() {
    Dl_info info{};
    ::dladdr(reinterpret_cast<const void*>(&segue::task_host::installed_libraries), &info);
    std::printf("code from %s\n", std::filesystem::path(info.dli_fname).filename().c_str());
  }
};

}  // namespace links

SEGUE_COMPONENT(links::Component)
