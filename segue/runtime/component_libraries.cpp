// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/component_libraries.hpp>

#include <set>
#include <string>

namespace segue::runtime {

type::Value component_libraries(const model::ComponentCatalog& catalog) {
  std::set<std::string> names;
  for (const model::ComponentModel* model : catalog.all()) {
    if (!model->library.empty()) names.insert(model->library);
  }
  return type::Value(type::Value::List(names.begin(), names.end()));
}

}  // namespace segue::runtime
