// SPDX-License-Identifier: Apache-2.0
//
// RAFCON's core_data.json: documents separated by NUL; the first is the root, the others are its children.
// What becomes a mission is written and read back equal.
#include "require.hpp"

#include <segue/mission/mission_io.hpp>
#include <segue/rafcon/rafcon_state.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace {

using namespace segue;
using namespace segue::mission;

/// Library states use a machine that is always there: the root itself, or an action.
void add_libraries(detail::RafconFiles& files, const detail::RafconState& state) {
  if (state.kind == StateKind::Library && !files.libraries.contains(state.library)) {
    auto library = std::make_unique<detail::RafconState>();
    library->id = library->name = "library";
    library->outcomes[0] = "success";
    files.libraries[state.library] = std::move(library);
  }
  for (const auto& child : state.children)
    add_libraries(files, *child);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  Diagnostics diagnostics;
  detail::RafconFiles files;
  while (true) {
    const auto end = text.find('\0');
    auto state = detail::read_core_data(text.substr(0, end), "f.json", diagnostics);
    if (!state) return 0;
    if (!files.root) {
      files.root = std::move(state);
    } else if (is_container(files.root->kind)) {
      files.root->children.push_back(std::move(state));
    }
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  add_libraries(files, *files.root);
  const auto import = detail::convert(files, diagnostics);
  fuzz::require(import.has_value() != diagnostics.has_errors(), "a mission or errors");
  if (!import) return 0;
  (void)validate(import->mission);
  Diagnostics again;
  const std::string written = write_mission(import->mission);
  const auto copy = read_mission(written, "written.yaml", again);
  fuzz::require(copy.has_value(), to_string(again) + "\n" + written);
  fuzz::require(*copy == import->mission, "what is written reads back equal:\n" + written);
  return 0;
}
