// SPDX-License-Identifier: Apache-2.0
#include "mission_load.hpp"

namespace segue::cli {

std::vector<mission::RafconLibraryPath> rafcon_library_paths(const std::vector<std::string>& given) {
  std::vector<mission::RafconLibraryPath> paths;
  for (const std::string& entry : given) {
    const auto equals = entry.find('=');
    const std::filesystem::path folder = equals == std::string::npos ? entry : entry.substr(equals + 1);
    paths.push_back(
        {equals == std::string::npos ? folder.filename().string() : entry.substr(0, equals), folder});
  }
  return paths;
}

std::optional<mission::Mission> load_mission(const std::filesystem::path& file,
                                             const std::vector<std::string>& libraries,
                                             Diagnostics& diagnostics) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(file, ignored))
    return mission::load_mission(file, {libraries.begin(), libraries.end()}, diagnostics);
  const std::size_t errors_before = diagnostics.error_count();
  auto machine = mission::import_rafcon(file, rafcon_library_paths(libraries), diagnostics);
  if (machine) diagnostics.append(mission::validate(machine->mission));
  if (!machine || diagnostics.error_count() > errors_before) return std::nullopt;
  return std::move(machine->mission);
}

}  // namespace segue::cli
