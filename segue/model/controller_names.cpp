// SPDX-License-Identifier: Apache-2.0
#include <segue/model/controller_names.hpp>

#include <algorithm>
#include <string>

namespace segue::model {

std::vector<NetworkName> controllers_in(std::string_view name) {
  std::vector<NetworkName> controllers;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find(kControllerSeparator), name.size());
    controllers.emplace_back(name.substr(0, end));
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  std::ranges::sort(controllers);
  controllers.erase(std::unique(controllers.begin(), controllers.end()), controllers.end());
  return controllers;
}

NetworkName joined_name(const std::vector<NetworkName>& controllers) {
  std::vector<NetworkName> sorted = controllers;
  std::ranges::sort(sorted);
  std::string text;
  for (const NetworkName& one : sorted) {
    if (!text.empty()) text += kControllerSeparator;
    text += one.str();
  }
  return NetworkName(text);
}

}  // namespace segue::model
