// SPDX-License-Identifier: Apache-2.0
#include <segue/base/install_prefix.hpp>

#include <dlfcn.h>

#include <system_error>

namespace segue {

std::vector<std::filesystem::path> install_prefixes() {
  namespace fs = std::filesystem;
  std::vector<fs::path> prefixes;
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  if (!failed) prefixes.push_back(self.parent_path().parent_path());
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&install_prefixes), &info) != 0 && info.dli_fname != nullptr) {
    const fs::path own = fs::absolute(info.dli_fname, failed).parent_path();
    prefixes.push_back(own.parent_path());
    prefixes.push_back(own.parent_path().parent_path());
  }
  return prefixes;
}

}  // namespace segue
