// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/solve/hash_index.hpp>

#include <vector>

namespace segue::solve::detail {

/// The facts about a component that the solver needs.
struct ComponentFacts {
  const model::ComponentModel* model = nullptr;  ///< nullptr: the catalog lacks it
  bool dynamic = false;                          ///< it has dynamic ports
};

/// Looks up each component once. The catalog and the given names must outlive it.
class KnownComponents {
 public:
  explicit KnownComponents(const model::ComponentCatalog& catalog)
      : catalog_(&catalog), names_(catalog.size()) {}

  [[nodiscard]] const type::TypeRegistry& types() const { return catalog_->types(); }
  ComponentFacts of(const model::ComponentName& name) {
    if (catalog_->size() == 0) return {};
    const int number = names_.intern(name.str());
    if (as_index(number) == facts_.size()) {
      const model::ComponentModel* model = catalog_->find(name);
      facts_.push_back({model, model != nullptr && model->has_dynamic_ports()});
    }
    return facts_[as_index(number)];
  }

 private:
  const model::ComponentCatalog* catalog_;
  Interner names_;
  std::vector<ComponentFacts> facts_;
};

/// Whether the component's port exists only while its task is configured.
inline bool is_dynamic(const ComponentFacts& component, std::string_view port, model::Direction direction) {
  if (!component.dynamic) return false;
  const model::PortModel* model = component.model->find_port(port, direction);
  return model != nullptr && (model->dynamic || model->pattern);
}

/// Whether two definitions differ in live properties of the component only. A property that only one of them
/// sets counts as a difference.
bool differ_only_live(const model::Task& now, const model::Task& then, const model::ComponentModel* model);

}  // namespace segue::solve::detail
