// SPDX-License-Identifier: Apache-2.0
//
// The readers of network, transition, robot and component files; the first byte chooses.
#include "require.hpp"

#include <segue/model/files.hpp>
#include <segue/model/rock_properties.hpp>
#include <segue/model/validate.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace segue::model {
namespace {

using fuzz::require;

/// The kinds of problems that were found.
std::set<std::string> codes(const Diagnostics& diagnostics) {
  std::set<std::string> codes;
  for (const Diagnostic& item : diagnostics.items())
    codes.insert(item.code);
  return codes;
}

void network(std::string_view text) {
  Diagnostics diagnostics;
  const auto network = read_network(text, "f.yaml", diagnostics);
  require(network.has_value() != diagnostics.has_errors(), "a network or errors");
  if (!network) return;
  (void)validate(*network, ComponentCatalog(), Depth::Full);
  const std::string written = write_network(*network);
  Diagnostics again;
  const auto copy = read_network(written, "written.yaml", again);
  const bool nothing_new = std::ranges::includes(codes(diagnostics), codes(again));
  require(copy.has_value() && nothing_new, to_string(again) + "\n" + written);
  require(*copy == *network, "what is written reads back equal:\n" + written);
}

void transition(std::string_view text) {
  Diagnostics diagnostics;
  const auto transition = read_transition(text, "f.yaml", diagnostics);
  require(transition.has_value() != diagnostics.has_errors(), "a transition or errors");
  if (!transition) return;
  const std::string written = write_transition(*transition);
  Diagnostics again;
  const auto copy = read_transition(written, "written.yaml", again);
  require(copy.has_value() && again.empty(), to_string(again) + "\n" + written);
  require(*copy == *transition, "what is written reads back equal:\n" + written);
}

void robot(std::string_view text) {
  Diagnostics diagnostics;
  const auto robot = read_robot(text, "f.yaml", diagnostics);
  require(robot.has_value() != diagnostics.has_errors(), "a robot or errors");
  if (robot) (void)validate(*robot, {});
}

void property_sections(std::string_view text) {
  Diagnostics diagnostics;
  const auto sections = detail::read_property_sections(text, "f.yml", diagnostics);
  require(sections.has_value() != diagnostics.has_errors(), "sections or errors");
}

void components(std::string_view text, const std::string& file) {
  Diagnostics diagnostics;
  ComponentCatalog catalog;
  const bool fine = read_components(text, file, catalog, diagnostics);
  require(fine != diagnostics.has_errors(), "success or errors");
  resolve_inheritance(catalog, diagnostics);
  if (diagnostics.has_errors()) return;
  std::vector<ComponentName> names;
  for (const ComponentModel* model : catalog.all())
    names.push_back(model->name);
  const std::string written = write_components(catalog, names);
  ComponentCatalog copy;
  Diagnostics again;
  require(read_components(written, "written.yaml", copy, again), to_string(again) + "\n" + written);
  resolve_inheritance(copy, again);
  require(!again.has_errors(), to_string(again) + "\n" + written);
  for (const ComponentName& name : names) {
    const ComponentModel* model = copy.find(name);
    require(model != nullptr && *model == *catalog.find(name),
            "what is written reads back equal:\n" + written);
  }
}

}  // namespace
}  // namespace segue::model

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 6) {
    case 0:
      segue::model::network(text);
      break;
    case 1:
      segue::model::transition(text);
      break;
    case 2:
      segue::model::robot(text);
      break;
    case 3:
      segue::model::components(text, "f.yaml");
      break;
    case 4:
      segue::model::components(text, "f.orogen");
      break;
    default:
      segue::model::property_sections(text);
  }
  return 0;
}
