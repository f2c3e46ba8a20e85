// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>

#include <algorithm>
#include <map>
#include <unordered_set>

namespace segue::model {
namespace {

/// "Task" in "camera::Usb" may mean "camera::Task".
const ComponentModel* find_parent(const ComponentCatalog& catalog, const ComponentModel& model) {
  if (const ComponentModel* parent = catalog.find(ComponentName(model.parent))) return parent;
  const auto colons = model.name.str().rfind("::");
  if (colons == std::string::npos) return nullptr;
  return catalog.find(ComponentName(model.name.str().substr(0, colons + 2) + model.parent));
}

template <class Items>
void append_texts(Items& items, const Items& more) {
  for (const auto& item : more) {
    if (std::ranges::find(items, item) == items.end()) items.push_back(item);
  }
}

template <class Items, class Same>
void append_missing(Items& items, const Items& more, Same same) {
  for (const auto& item : more) {
    if (std::ranges::none_of(items, [&](const auto& own) { return same(own, item); })) items.push_back(item);
  }
}

void inherit(ComponentModel& child, const ComponentModel& parent) {
  append_missing(child.ports, parent.ports, [](const PortModel& a, const PortModel& b) {
    return a.name == b.name && a.direction == b.direction && a.pattern == b.pattern &&
           (!a.pattern || a.type == b.type);
  });
  auto same_name = [](const auto& a, const auto& b) { return a.name == b.name; };
  append_missing(child.properties, parent.properties, same_name);
  append_missing(child.operations, parent.operations, same_name);
  append_texts(child.nominal_states, parent.nominal_states);
  append_texts(child.error_states, parent.error_states);
  append_texts(child.descriptors, parent.descriptors);
  append_texts(child.exclusive, parent.exclusive);
  child.incomplete = child.incomplete || parent.incomplete;
  if (child.own_activity) return;
  child.activity = parent.activity;
  child.trigger_ports = parent.trigger_ports;
  child.own_activity = parent.own_activity;
}

/// Resolves each model once, its ancestors first.
class Resolver {
 public:
  Resolver(ComponentCatalog& catalog, Diagnostics& diagnostics)
      : catalog_(catalog), diagnostics_(diagnostics) {}

  /// Iterative, since chains of parents may be long.
  void resolve(const ComponentName& name) {
    std::vector<ComponentName> chain;
    std::unordered_set<ComponentName> on_chain;
    for (ComponentName current = name;;) {
      const ComponentModel* model = catalog_.find(current);
      if (model == nullptr || model->parent.empty()) break;
      if (!on_chain.insert(current).second) {
        diagnostics_.error("inheritance-cycle", "component " + quote(current.str()) + " is its own ancestor",
                           model->where);
        forget_parents(chain);
        return;
      }
      chain.push_back(current);
      const ComponentModel* parent = find_parent(catalog_, *model);
      if (parent == nullptr) {
        report_missing(*model);
        break;
      }
      current = parent->name;
    }
    for (auto link = chain.rbegin(); link != chain.rend(); ++link)
      take_over(*link);
  }

 private:
  void report_missing(const ComponentModel& model) {
    diagnostics_.warning("unknown-parent",
                         "component " + quote(model.name.str()) + " extends " + quote(model.parent) +
                             ", which is in none of the files: its interface may lack ports and properties",
                         model.where);
  }

  void take_over(const ComponentName& name) {
    ComponentModel model = *catalog_.find(name);
    if (const ComponentModel* parent = find_parent(catalog_, model)) {
      inherit(model, *parent);
    } else {
      model.incomplete = true;
    }
    model.parent.clear();
    catalog_.add(std::move(model));
  }

  void forget_parents(const std::vector<ComponentName>& names) {
    for (const ComponentName& name : names) {
      ComponentModel model = *catalog_.find(name);
      model.parent.clear();
      catalog_.add(std::move(model));
    }
  }

  ComponentCatalog& catalog_;
  Diagnostics& diagnostics_;
};

}  // namespace

void resolve_inheritance(ComponentCatalog& catalog, Diagnostics& diagnostics) {
  std::vector<ComponentName> names;
  for (const ComponentModel* model : catalog.all())
    names.push_back(model->name);
  Resolver resolver(catalog, diagnostics);
  for (const ComponentName& name : names)
    resolver.resolve(name);
  catalog.register_composite_types();
}

}  // namespace segue::model
